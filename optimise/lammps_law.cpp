#include "optimise/lammps_law.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "dem/bed.h"

namespace gradwright {

double tsuji_damping(double n) {
    return 1.2728 + n * (-4.2783 + n * (11.087 + n * (-22.348 + n * (27.467 + n * (-18.022 + n * 4.8218)))));
}

double tsuji_number(double restitution) {
    // beta = -ln e / sqrt(ln^2 e + pi^2); the polynomial falls from 11 at -0.8 to its minimum beyond 1, so
    // that halving finds the one crossing.
    const double log_e = std::log(restitution);
    const double wanted = std::sqrt(5.0) * -log_e / std::hypot(log_e, std::numbers::pi);
    double low = -0.8, high = 1.05;
    for (int k = 0; k < 200; ++k) {
        const double middle = 0.5 * (low + high);
        (tsuji_damping(middle) > wanted ? low : high) = middle;
    }
    return 0.5 * (low + high);
}

LammpsLaw::LammpsLaw(const Scene& scene, bool rolling)
    : interaction_(scene.interaction),
      rolling_(rolling),
      poissons_ratio_(scene.powder[0].material.poissons_ratio) {
    const Engine engine(engine_options(scene, 1));
    for (int a = 0; a < 3; ++a)
        for (int b = 0; b < 3; ++b) constants_.push_back(engine.pair_constants(a, b));
    adhesion_ = engine.work_of_adhesion();
    damping_number_ = tsuji_number(interaction_.coefficient_of_restitution);
    median_radius_ = 0.5 * scene.powder[0].size.number_quantile(0.5);
    median_mass_ = scene.powder[0].material.density * sphere_volume(median_radius_);
}

std::string LammpsLaw::rest(const PairConstants& k, bool wall, bool frictionless) const {
    const double friction = frictionless ? 0 : interaction_.static_friction;
    std::string out = fmt::format(" tangential mindlin {:.17g} {:.17g} {:.17g}", k.g_star8,
                                  std::sqrt(k.g_star8 / (2 * k.e_star)), friction);
    const double resistance = interaction_.rolling_friction;
    if (rolling_ && !frictionless && resistance > 0 && interaction_.rolling_model != RollingModel::none) {
        const double radius = wall ? median_radius_ : 0.5 * median_radius_;
        const double mass = wall ? median_mass_ : 0.5 * median_mass_;
        // Adhesion alone (F = 0): s^3 = 3/2, a = a_s s^2. Without adhesion: an overlap of a thousandth.
        const double contact =
            adhesion_ > 0 ? std::cbrt(2 * std::numbers::pi * adhesion_ * radius * radius / k.e_star) *
                                std::pow(1.5, 2.0 / 3.0)
                          : std::sqrt(radius * 1e-3 * median_radius_);
        // torque = R* (k_roll R* angle) there, 2.25 S_n (mu_r R*)^2 angle here
        const double stiffness = 2.25 * 2 * k.e_star * contact * resistance * resistance;
        // dashpot 2 eta_r sqrt(I_r k_r) with eta_r = 0.3, I_r = 7/5 m* r^2, per R*^2
        const double dashpot = 0.6 * std::sqrt(1.4 * mass * stiffness) * median_radius_ / radius;
        out += fmt::format(" rolling sds {:.6g} {:.6g} {:.17g}", stiffness, dashpot, resistance);
    }
    return out + " damping tsuji";
}

std::string LammpsLaw::pair(int material_i, int material_j) const {
    PairConstants k = constants(material_i, material_j);
    // Two fixed grains never meet: any numbers will do, but there must be some.
    if (!(k.e_star > 0)) k = constants(0, 0);
    const double nu = poissons_ratio_;
    const double youngs_modulus = 2 * (1 - nu * nu) * k.e_star;
    const std::string normal = adhesive() ? fmt::format("jkr {:.17g} {:.17g} {:.17g} {:.17g}", youngs_modulus,
                                                        damping_number_, nu, 0.5 * adhesion_)
                                          : fmt::format("hertz/material {:.17g} {:.17g} {:.17g}",
                                                        youngs_modulus, damping_number_, nu);
    return normal + rest(k, false, false);
}

double wall_softening(const Body& body) {
    return body.yield_ratio > 0 ? 2.5 * std::pow(body.yield_ratio, 1.5) : 1;
}

std::string LammpsLaw::wall(int material, bool frictionless, double softer) const {
    PairConstants k = constants(material, kWallMaterial);
    k.e_star *= softer;
    k.g_star8 *= softer;
    const double nu = poissons_ratio_;
    return fmt::format("hertz/material {:.17g} {:.17g} {:.17g}", 2 * (1 - nu) * k.e_star, damping_number_,
                       nu) +
           rest(k, true, frictionless);
}

std::vector<std::string> lammps_differences(const Scene& scene, bool rigid_blade) {
    const Interaction& i = scene.interaction;
    std::vector<std::string> out;
    const bool adhesive = i.work_of_adhesion > 0;
    if (adhesive)
        out.push_back(!scene.adhesive_walls
                          ? "walls: plain Hertz in both (LAMMPS's JKR walls take the pull-off "
                            "distance with the wrong sign "
                            "and end in NaN); fixed rough grains adhere in both"
                          : "walls: JKR in ours, plain Hertz in LAMMPS (its JKR walls take the "
                            "pull-off distance with the "
                            "wrong sign and end in NaN); fixed rough grains adhere in both");
    if (i.rolling_friction > 0) {
        const char* const ours = i.rolling_model == RollingModel::spring            ? "spring"
                                 : i.rolling_model == RollingModel::constant_torque ? "constant_torque"
                                 : i.rolling_model == RollingModel::none            ? "none"
                                                                                    : "edem";
        out.push_back(fmt::format(
            "rolling: {} in ours, sds in LAMMPS: the same cap mu_r R* F_cap, its spring stiffness constant "
            "(ours "
            "at a pair of median grains) instead of growing with the contact, its dashpot inside the cap",
            ours));
    }
    if (scene.blade_speed > 0)
        out.push_back(
            std::string("blade: yields in ours (a pinched grain is pressed with the force of an overlap of "
                        "0.6 % r at most), ") +
            (rigid_blade
                 ? "rigid in LAMMPS"
                 : "in LAMMPS a plain Hertz wall soft enough to do the same work on a grain pressed in "
                   "by its radius (a rigid one shoots what it pinches at an edge through the heap)"));
    if (i.friction_cap != FrictionCap::thornton)
        out.push_back("friction cap: the study's in ours, thornton's in LAMMPS");
    out.push_back(
        "friction cap at walls: max(F_n, 0) without adhesion in ours, |F_n| with its damping part in LAMMPS");
    out.push_back(
        "sliding: speed at r - delta/2 (pairs) and r - delta (walls) in ours, at r in LAMMPS; torque of a "
        "wall "
        "at r in LAMMPS; a slipping spring in LAMMPS keeps the dashpot's part");
    out.push_back(
        "tangential dashpots: each at most a quarter of 1/dt on a grain's slip in ours, so that a packing "
        "stays "
        "stable (felt above 0.8 % overlap at e = 0.5 and 0.2 T_R); without limit in LAMMPS");
    out.push_back(
        "integration: ours feeds damping and friction velocities predicted for the whole step and integrates "
        "xi "
        "by the trapezoidal rule, LAMMPS takes those of the half step");
    if (adhesive)
        out.push_back(
            "stretched bonds: live to the tear-off overlap in ours (grains drawn apart), break in LAMMPS "
            "where the "
            "pull is largest (a dead load), at 0.48 of it");
    if (scene.sleep) out.push_back("grains at rest in a quiet neighbourhood are not computed in ours");
    if (scene.precision == Precision::single_law)
        out.push_back("the contact law runs in single precision in ours (positions and sums in double)");
    return out;
}

}  // namespace gradwright
