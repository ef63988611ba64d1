// The build without OpenCASCADE.
#include <stdexcept>

#include "reports/step_file.h"

namespace gradwright {

bool step_available() {
    return false;
}

void write_step(const std::vector<Plate>&, const StepNames&, StepSchema, const std::string&) {
    throw std::logic_error(std::string("built without OpenCASCADE: install ") + kStepPackage);
}

}  // namespace gradwright
