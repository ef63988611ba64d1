// From the command line to the options of a run: shared by the verbs that simulate.
#pragma once
#include <exception>
#include <string>

#include "cli/common.h"
#include "cli/progress.h"
#include "optimise/design_run.h"

namespace gradwright::cli {

/// Threads, cache, progress and the stop flag of the signals. `progress` must outlive the run.
RunOptions run_options(const CommonOptions& common, ProgressLine& progress);

/// "kinematic" | "map" | "full" | "lammps"; anything else is Failure usage with the nearest name.
Fidelity fidelity_of(const std::string& name);

/// Calls `write`; a file that cannot be written becomes Failure io that names the folder.
template <class Write>
auto writing(const std::string& folder, Write write) -> decltype(write()) {
    try {
        return write();
    } catch (const Failure&) {
        throw;
    } catch (const std::exception& error) {
        throw Failure(ExitCode::io, error.what(), "is there space and a right to write in '" + folder + "'?");
    }
}

}  // namespace gradwright::cli
