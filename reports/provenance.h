// Which program made a result: version, source state, compiler, instruction set, libraries.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace gradwright {

/// Flat object of texts: program, version, source (git describe at configure time, "unknown" outside a
/// repository), compiler, flags, instruction_set (compiled for), hdf5.
nlohmann::json provenance_json();
/// Widest instruction set the program was compiled for, e.g. "AVX2 + FMA".
std::string compiled_instruction_set();

}  // namespace gradwright
