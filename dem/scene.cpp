#include "dem/scene.h"

#include <fmt/format.h>

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
    if (!adhesive_walls) number("adhesive_walls", 0);
    number("softening", softening);
    number("adhesion_scaling", static_cast<int>(adhesion_scaling));
    number("rayleigh_fraction", rayleigh_fraction);
    number("gravity", gravity);
    number("sleep", sleep);
    number("precision", static_cast<int>(precision));
    out += fmt::format("seed = {}\n", seed);
    return out;
}

}  // namespace gradwright
