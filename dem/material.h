// Material of grains and walls, and the interaction shared by all pairs.
#pragma once
#include <string>
#include <vector>

namespace gradwright {

struct ElementShare {
    std::string element;    ///< chemical symbol: "Fe"
    double wt_percent = 0;  ///< share by mass [wt%], > 0
};

struct Material {
    std::string name;
    double density = 0;                          ///< [kg/m3], > 0
    double youngs_modulus = 0;                   ///< real, unsoftened [Pa], > 0
    double poissons_ratio = 0.3;                 ///< [-], 0 <= nu < 0.5
    std::string source;                          ///< where the numbers come from
    std::vector<ElementShare> composition = {};  ///< nominal; empty = not known. No spread depends on it
    std::string composition_source = {};
};

enum class FrictionCap { thornton, edem_repulsive, normal };
enum class RollingModel { none, constant_torque, spring, edem };
enum class AdhesionScaling { cohesion_number, none };

/// Interaction of every pair and wall (one set: the paper uses one for all pairs, table 1).
struct Interaction {
    double static_friction = 0.64;            ///< mu [-], >= 0
    double coefficient_of_restitution = 0.5;  ///< e of the damping without adhesion [-], 0 < e <= 1
    double rolling_friction = 0.1;            ///< mu_r [-], >= 0
    double work_of_adhesion = 0.02;           ///< Gamma, unsoftened [J/m2], >= 0; 0 = plain Hertz
    FrictionCap friction_cap = FrictionCap::thornton;
    RollingModel rolling_model = RollingModel::constant_torque;
    double rolling_regularisation_speed =
        1e-4;  ///< [m/s]: constant_torque and edem are linear (creep) below it; 1e-3 keeps beds from settling
};

}  // namespace gradwright
