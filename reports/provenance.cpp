#include "reports/provenance.h"

#include <fmt/format.h>
#include <hdf5.h>

#include "reports/build_facts.h"
#include "reports/source_state.h"

namespace gradwright {

std::string compiled_instruction_set() {
#if defined(__AVX512F__)
    return "AVX-512";
#elif defined(__AVX2__) && defined(__FMA__)
    return "AVX2 + FMA";
#elif defined(__AVX__)
    return "AVX";
#elif defined(__aarch64__)
    return "AArch64 NEON";
#else
    return "baseline";
#endif
}

nlohmann::json provenance_json() {
    unsigned major = 0, minor = 0, release = 0;
    H5get_libversion(&major, &minor, &release);
    return {{"program", "gradwright"},
            {"version", build_facts::kVersion},
            {"source", build_facts::kSource},
            {"compiler", build_facts::kCompiler},
            {"flags", build_facts::kFlags},
            {"instruction_set", compiled_instruction_set()},
            {"hdf5", fmt::format("{}.{}.{}", major, minor, release)}};
}

}  // namespace gradwright
