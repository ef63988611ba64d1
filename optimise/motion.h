// What a design sets besides the partition: by name, in the study and in the design. All but the footprint's
// place move grains, so that a new value needs a new spread.
#pragma once
#include <array>
#include <string>

#include "optimise/study.h"

namespace gradwright {

struct MotionVariable {
    const char* name;       ///< key under design_space, and of its Variable
    const char* unit;       ///< SI
    const char* dimension;  ///< as study files know it
    bool spreads;           ///< a new value needs a new spread; false: the map is only read elsewhere
    const Variable& (*in)(const DesignSpace&);
    double& (*of)(Design&);
};

inline constexpr std::array<MotionVariable, kMotionCount> kMotionVariables = {{
    {"dosage_factor", "1", "", true, [](const DesignSpace& s) -> const Variable& { return s.dosage_factor; },
     [](Design& d) -> double& { return d.dosage_factor; }},
    {"land", "m", "length", true, [](const DesignSpace& s) -> const Variable& { return s.land; },
     [](Design& d) -> double& { return d.land; }},
    {"footprint_offset", "m", "length", false,
     [](const DesignSpace& s) -> const Variable& { return s.footprint_offset; },
     [](Design& d) -> double& { return d.footprint_offset; }},
    {"dose.A", "1", "", true, [](const DesignSpace& s) -> const Variable& { return s.dose[0]; },
     [](Design& d) -> double& { return d.dose[0]; }},
    {"dose.B", "1", "", true, [](const DesignSpace& s) -> const Variable& { return s.dose[1]; },
     [](Design& d) -> double& { return d.dose[1]; }},
    {"fill_fraction.A", "1", "", true,
     [](const DesignSpace& s) -> const Variable& { return s.fill_fraction[0]; },
     [](Design& d) -> double& { return d.fill_fraction[0]; }},
    {"fill_fraction.B", "1", "", true,
     [](const DesignSpace& s) -> const Variable& { return s.fill_fraction[1]; },
     [](Design& d) -> double& { return d.fill_fraction[1]; }},
    {"blade_speed", "m/s", "speed", true,
     [](const DesignSpace& s) -> const Variable& { return s.blade_speed; },
     [](Design& d) -> double& { return d.blade_speed; }},
    {"layer_thickness", "m", "length", true,
     [](const DesignSpace& s) -> const Variable& { return s.layer_thickness; },
     [](Design& d) -> double& { return d.layer_thickness; }},
}};

/// Of a design, with the study's own where the design leaves them to it.
inline MotionValues motion_values(const Study& study, const Design& design) {
    Design full = design;
    if (full.land < 0) full.land = study.scene.land;
    if (full.blade_speed < 0) full.blade_speed = study.scene.blade_speed;
    if (full.layer_thickness < 0) full.layer_thickness = study.scene.layer_thickness;
    MotionValues values = {};
    for (std::size_t i = 0; i < kMotionCount; ++i) values[i] = kMotionVariables[i].of(full);
    return values;
}

/// Names of those that are free, "dosage_factor, land"; `spreading`: of those alone that need a new spread.
inline std::string free_motion(const DesignSpace& space, bool spreading = false) {
    std::string names;
    for (const MotionVariable& motion : kMotionVariables)
        if (motion.in(space).free && (motion.spreads || !spreading))
            names += (names.empty() ? "" : ", ") + std::string(motion.name);
    return names;
}

}  // namespace gradwright
