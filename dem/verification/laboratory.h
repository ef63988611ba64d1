// Small set-ups shared by the rungs: materials, one impact watched step by step, and the judging of a number.
// Private.
#pragma once
#include <cmath>
#include <limits>
#include <string>

#include "dem/engine.h"
#include "dem/verification/verification.h"

namespace gradwright::verification {

inline constexpr double kPi = 3.14159265358979323846;

/// A case whose error is |obtained - expected| / scale. Not-a-number never passes.
inline VerificationCase judged(std::string id, std::string name, std::string quantity, double expected,
                               double obtained, double scale, double tolerance, std::string source) {
    VerificationCase c;
    c.id = std::move(id);
    c.name = std::move(name);
    c.quantity = std::move(quantity);
    c.expected = expected;
    c.obtained = obtained;
    c.error = std::fabs(obtained - expected) / std::fabs(scale);
    c.tolerance = tolerance;
    c.source = std::move(source);
    c.pass = c.error <= tolerance;
    return c;
}

inline Material grain_material(double density, double youngs_modulus, double poissons_ratio) {
    return {"grain", density, youngs_modulus, poissons_ratio, ""};
}
inline Material rigid_material() {
    return {"rigid", 1000, std::numeric_limits<double>::infinity(), 0.3, ""};
}

/// Neither friction, damping, rolling resistance nor adhesion.
inline Interaction bare_interaction() {
    Interaction i;
    i.static_friction = 0;
    i.coefficient_of_restitution = 1;
    i.rolling_friction = 0;
    i.work_of_adhesion = 0;
    return i;
}

/// Unsoftened engine without gravity: material 0 = `grain`, 1 = rigid.
inline EngineOptions laboratory_options(const VerificationOptions& options, const Material& grain,
                                        const Interaction& interaction, double time_step) {
    EngineOptions o;
    o.materials = {grain, rigid_material()};
    o.interaction = interaction;
    o.time_step = time_step;
    o.gravity = {0, 0, 0};
    o.precision = options.precision;
    o.threads = 1;
    o.speed_limit = 1000;
    o.fault = options.fault;
    return o;
}

/// Storage order changes when lists are made anew: find a grain by its number.
inline std::size_t index_of(const Engine& engine, int id) {
    const auto& ids = engine.state().id;
    for (std::size_t i = 0; i < ids.size(); ++i)
        if (ids[i] == id) return i;
    return ids.size();
}

inline double sphere_mass(double density, double radius) {
    return density * 4.0 / 3.0 * kPi * radius * radius * radius;
}

/// Elastic Hertz impact, closed form: k = 4/3 E* sqrt(R*), delta_max = (5 m* V^2/(4 k))^(2/5), t_c = 2.9432
/// delta_max/V.
struct HertzImpact {
    double overlap_max, force_max, contact_time;
};
inline HertzImpact hertz_impact(double e_star, double r_star, double m_star, double speed) {
    const double k = 4.0 / 3.0 * e_star * std::sqrt(r_star);
    const double overlap = std::pow(5 * m_star * speed * speed / (4 * k), 0.4);
    return {overlap, k * std::pow(overlap, 1.5), 2.943275 * overlap / speed};
}

/// Two grains, or a grain and a rigid plane, meet along x; y is tangential, spins are about z.
struct ImpactSetup {
    Material material;
    Interaction interaction = bare_interaction();
    double radius_1 = 0;
    double radius_2 = 0;          ///< 0: rigid plane
    double normal_speed = 0;      ///< closing [m/s]
    double tangential_speed = 0;  ///< of grain 1's centre against the other [m/s]
    double spin_1 = 0, spin_2 = 0;
    double steps_per_contact = 1000;  ///< of an elastic contact of the same speed
    double phase = 0.37;              ///< touch happens at this fraction of a step
};
struct ImpactResult {
    double overlap_max = 0, force_max = 0, contact_time = 0;
    double normal_speed = 0;      ///< separating [m/s]
    double tangential_speed = 0;  ///< centres [m/s]
    double spin_1 = 0, spin_2 = 0;
    long steps_in_contact = 0;
};
ImpactResult run_impact(const VerificationOptions& options, const ImpactSetup& setup);

/// E* of two like grains, or of a grain on a rigid plane.
inline double effective_modulus(const Material& m, bool wall) {
    const double plane_strain = m.youngs_modulus / (1 - m.poissons_ratio * m.poissons_ratio);
    return wall ? plane_strain : 0.5 * plane_strain;
}

}  // namespace gradwright::verification
