// A first study for a machine and two powders, written out with every value, its unit and a comment: what
// `gradwright init` puts on the disk. Whatever nobody has measured says "measure this".
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "dem/size_distribution.h"

namespace gradwright {

/// Shapes of a target that a draft can be written with: those that need no file of their own.
inline constexpr std::array<const char*, 5> kDraftTargets = {"linear", "sigmoid", "step", "plateaus", "aba"};

/// D10, D50, D90 by volume [m].
struct GrainSizes {
    double d10 = 0, d50 = 0, d90 = 0;
};

struct DraftOptions {
    std::string file;                   ///< where the study will lie: `machine` is relative to its folder
    std::string name;                   ///< of the study; empty = the file's stem
    std::string machine;                ///< shipped name, or a path ending in .toml
    std::array<std::string, 2> powder;  ///< names of the material table
    std::array<std::optional<GrainSizes>, 2> size;  ///< none: A the default powder's, marked; B as A
    std::string target = "linear";                  ///< one of kDraftTargets
    double layer_thickness = 40e-6;                 ///< [m]
};

struct StudyDraft {
    std::string text;  ///< TOML; read_study takes it without a problem
    std::string machine_title;
    bool scale_up = false;             ///< too large to be spread grain by grain: has [scale_up]
    std::vector<std::string> measure;  ///< keys whose values are stand-ins
};

/// Full-width spreads of more grain-steps than this are not proposed: a day on two cores at the assumed speed
/// of `check`.
inline constexpr double kLargestDraftedSpread = 1e12;

/// Throws InputError when the machine's file cannot be used or no sound study can be made of the numbers.
StudyDraft draft_study(const DraftOptions& options);

}  // namespace gradwright
