#include "cli/run_options.h"

#include <fmt/format.h>

#include "cli/signals.h"

namespace gradwright::cli {

RunOptions run_options(const CommonOptions& common, ProgressLine& progress) {
    RunOptions run;
    run.threads = thread_count(common);
    run.cache_folder = cache_folder(common);
    run.progress = [&progress](const std::string& stage, double fraction) {
        progress.update(stage, fraction);
    };
    run.stop = watch_signals();
    if (common.verbose > 0)
        fmt::print(stderr, "gradwright: {} threads; cache {}\n", run.threads,
                   run.cache_folder.empty() ? "off" : run.cache_folder);
    return run;
}

Fidelity fidelity_of(const std::string& name) {
    std::vector<std::string> valid;
    for (const Fidelity fidelity : {Fidelity::kinematic, Fidelity::map, Fidelity::full, Fidelity::lammps}) {
        if (name == gradwright::to_string(fidelity)) return fidelity;
        valid.push_back(gradwright::to_string(fidelity));
    }
    throw Failure(ExitCode::usage,
                  fmt::format("--fidelity: there is no fidelity '{}'{}", name, hint(name, valid)),
                  fmt::format("one of {}", fmt::join(valid, ", ")));
}

}  // namespace gradwright::cli
