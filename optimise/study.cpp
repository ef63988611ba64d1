// From the question and one point of the design space to the scene of one spread (physics.md 1).
#include "optimise/study.h"

#include <algorithm>

namespace gradwright {

const char* to_string(Family family) {
    return kFamilies.at(static_cast<std::size_t>(family));
}

std::optional<Family> family_of(std::string_view name) {
    for (std::size_t i = 0; i < kFamilies.size(); ++i)
        if (name == kFamilies[i]) return static_cast<Family>(i);
    return {};
}

Scene scene_of(const Study& study, const Design& design, bool strip, std::uint64_t seed) {
    Scene scene = study.scene;
    scene.width = strip ? study.strip_width : study.dispenser_width;
    // A map lives on y-homogeneity: no side walls, whatever the machine has.
    if (strip) {
        scene.sides = Sides::periodic;
        scene.share_a = {1, 0};  // its grains carry no powder
    }
    scene.land = design.land >= 0 ? design.land : study.scene.land;
    scene.blade_speed = design.blade_speed > 0 ? design.blade_speed : study.scene.blade_speed;
    if (design.layer_thickness > 0) {
        scene.layer_thickness = design.layer_thickness;
        if (study.gap_steady)
            scene.gap = scene.layer_thickness / study.steady_packing;
        else if (study.gap_layer)
            scene.gap = scene.layer_thickness;
    }
    // Dispenser and platform are equally wide, so the ratio of areas is that of the lengths (physics.md 1.3).
    const double rise =
        design.dosage_factor * scene.layer_thickness * scene.platform_length / scene.dispenser_length;
    const double larger = std::max(design.dose[0], design.dose[1]);
    scene.dose_height = larger * rise;
    // Fill fraction phi leaves a headspace c = (1 - phi) depth below the rim, levelled away after the first
    // pass; a piston that rises less leaves its chamber lower in every pass.
    for (int chamber = 0; chamber < 2; ++chamber)
        scene.headspace[chamber] = (1 - design.fill_fraction[chamber]) * scene.dispenser_depth +
                                   (larger - design.dose[chamber]) * rise;  // 0, not a rounding below it
    scene.seed = seed;
    const double coarsening = strip ? study.map_coarsening : study.full_coarsening;
    return coarsening == 1 ? scene : coarse_grained(scene, coarsening);
}

int judged_number(const Study& study) {
    if (study.judged_layer == kAllLayers && study.scene.layers > 1) return 0;
    return study.judged_layer > 0 ? study.judged_layer : study.scene.layers;
}

std::vector<Layer> layers_of(const SpreadResult& spread) {
    std::vector<Layer> layers = spread.earlier;
    layers.push_back(spread.layer);
    return layers;
}

Layer judged_layer(const Study& study, const SpreadResult& spread) {
    if (spread.earlier.empty()) return spread.layer;
    const int number = judged_number(study);
    if (number == 0) return pooled(layers_of(spread));
    const auto before = static_cast<std::size_t>(number) - 1;
    return before < spread.earlier.size() ? spread.earlier[before] : spread.layer;
}

double supply_ratio(const Scene& scene, double bed_packing, double layer_packing) {
    const double needed = scene.gap * layer_packing * scene.platform_length;
    const double dose = scene.dose_height - 0.5 * (scene.headspace[0] + scene.headspace[1]);
    return needed > 0 ? dose * bed_packing * scene.dispenser_length / needed : 0;
}

}  // namespace gradwright
