#include "dem/scene.h"

#include <fmt/format.h>

#include <algorithm>

namespace gradwright {

std::string text_hash(const std::string& text) {
    // FNV-1a, 64 bit (Fowler, Noll, Vo)
    std::uint64_t hash = 14695981039346656037ull;
    for (const char c : text) {
        hash ^= static_cast<unsigned char>(c);
        hash *= 1099511628211ull;
    }
    return fmt::format("{:016x}", hash);
}

Scene coarse_grained(Scene scene, double factor) {
    for (Powder& powder : scene.powder)
        for (double* diameter : {&powder.size.d10, &powder.size.d50, &powder.size.d90, &powder.size.cut_low,
                                 &powder.size.cut_high})
            *diameter *= factor;
    for (double* height : {&scene.bed_depth, &scene.dose_height, &scene.headspace[0], &scene.headspace[1],
                           &scene.gap, &scene.layer_thickness, &scene.roughness, &scene.blade_tip_radius})
        *height *= factor;
    scene.dispenser_depth = std::max(scene.dispenser_depth, scene.floor_depth());
    scene.blade_tip_radius = std::min(scene.blade_tip_radius, scene.blade_thickness);
    scene.interaction.work_of_adhesion *= factor;
    return scene;
}

std::string Scene::canonical_text() const {
    std::string out;
    auto number = [&](const char* key, double value) { out += fmt::format("{} = {:.17g}\n", key, value); };
    number("dispenser_length", dispenser_length);
    number("width", width);
    number("bed_depth", bed_depth);
    number("dispenser_depth", dispenser_depth);
    number("land", land);
    number("platform_length", platform_length);
    number("second_land", second_land);
    number("blade_tip_radius", blade_tip_radius);
    number("blade_thickness", blade_thickness);
    number("blade_speed", blade_speed);
    number("dose_height", dose_height);
    number("headspace_a", headspace[0]);
    number("headspace_b", headspace[1]);
    number("gap", gap);
    number("layer_thickness", layer_thickness);
    number("substrate", static_cast<int>(substrate));
    number("roughness", roughness);
    number("sides", static_cast<int>(sides));
    number("plate_thickness", plate_thickness);
    number("allow_starved", allow_starved);
    auto material = [&](const char* key, const Material& m) {
        out +=
            fmt::format("{} = {:.17g} {:.17g} {:.17g}\n", key, m.density, m.youngs_modulus, m.poissons_ratio);
    };
    for (int k = 0; k < 2; ++k) {
        material(k == 0 ? "powder_a" : "powder_b", powder[k].material);
        const auto& size = powder[k].size;
        out += fmt::format("size = {:.17g} {:.17g} {:.17g} {:.17g} {:.17g}\n", size.d10, size.d50, size.d90,
                           size.cut_low, size.cut_high);
    }
    material("wall", wall);
    number("static_friction", interaction.static_friction);
    number("restitution", interaction.coefficient_of_restitution);
    number("rolling_friction", interaction.rolling_friction);
    number("work_of_adhesion", interaction.work_of_adhesion);
    number("friction_cap", static_cast<int>(interaction.friction_cap));
    number("rolling_model", static_cast<int>(interaction.rolling_model));
    number("rolling_speed", interaction.rolling_regularisation_speed);
    // named only where it departs, so that the beds and maps kept so far are still found
    if (share_a[0] != 1 || share_a[1] != 0)
        out += fmt::format("share_a = {:.17g} {:.17g}\n", share_a[0], share_a[1]);
    if (!adhesive_walls) number("adhesive_walls", 0);
    if (substrate == Substrate::powder) number("substrate_share_a", substrate_share_a);
    if (layers != 1) number("layers", layers);
    number("softening", softening);
    number("adhesion_scaling", static_cast<int>(adhesion_scaling));
    number("rayleigh_fraction", rayleigh_fraction);
    number("gravity", gravity);
    number("sleep", sleep);
    if (early_stop) number("early_stop", 1);
    number("precision", static_cast<int>(precision));
    out += fmt::format("seed = {}\n", seed);
    return out;
}

}  // namespace gradwright
