// The plates as exact solids in one STEP file (ISO 10303-21), written by OpenCASCADE: planes and cylinders,
// lengths in mm, one product for each plate. An optional part of the build: without OpenCASCADE everything
// else works.
#pragma once
#include <string>
#include <vector>

#include "reports/plate.h"

namespace gradwright {

enum class StepSchema { ap214, ap242 };

struct StepNames {
    std::string product;      ///< each plate's name is appended
    std::string description;  ///< of every product: material, thickness, marks
    std::string title;        ///< file description: first line of the header
    std::string organisation, author;
};

/// Was the program built with OpenCASCADE?
bool step_available();
/// Debian package that is missing where it was not.
inline constexpr const char* kStepPackage = "libocct-data-exchange-dev";

/// Throws std::runtime_error when OpenCASCADE cannot make or write the solids, std::logic_error without it.
/// The header carries a fixed date, so that the same plates give the same bytes.
void write_step(const std::vector<Plate>& plates, const StepNames& names, StepSchema schema,
                const std::string& path);

}  // namespace gradwright
