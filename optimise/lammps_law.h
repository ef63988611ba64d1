// Our contact law in LAMMPS's words (pair_style granular and fix wall/gran, release of 29 September 2021:
// what Debian 12 ships). Every conversion stands here once, with its reason; lammps_pairs.h holds the result
// to 1e-9.
//
// Notation as in dem/contact_law.h. LAMMPS's normal stiffness per contact radius is k = 4/3 E*; its damping
// is c sqrt(m* k a) v with c a polynomial of the number given after E ("damping tsuji"). So
//   normal      c = sqrt(5) beta, because 2 sqrt(5/6) beta sqrt(m* 2 E* a) = sqrt(5) beta sqrt(m* 4/3 E* a);
//   tangential  damping x c sqrt(m* k a) with x = sqrt(S_t/S_n) = sqrt(8 G*/(2 E*)); stiffness 8 G* given as
//   a
//               number (its NULL takes E and nu of the pair, and on walls another formula altogether);
//   JKR         gamma = Gamma/2: its surface energy is of one surface;
//   pair E      E = 2 (1 - nu^2) E*: it mixes the number with itself;
//   wall E      E = 2 (1 - nu) E*: fix wall/gran takes E/(2 (1 - nu)) for E*;
//   rolling     sds with a constant stiffness: ours, 2.25 S_n mu_r^2, at the contact of two median grains
//   that
//               adhesion alone presses together, and its dashpot likewise (inside the cap there, not here).
#pragma once
#include <string>
#include <vector>

#include "dem/engine.h"
#include "dem/scene.h"

namespace gradwright {

/// The number that makes LAMMPS's `damping tsuji` dissipate like a coefficient of restitution e in our law,
/// solved from its polynomial; 0 < e <= 1.
double tsuji_number(double restitution);
/// LAMMPS's polynomial itself: c of a number.
double tsuji_damping(double number);

/// Stiffness of a plain Hertz wall, over the real one's, that does as much work as a yielding one of ours
/// (Body::yield_ratio) on a grain pressed in by its radius: LAMMPS has no wall that yields, and a rigid blade
/// shoots what it pinches at an edge through the heap. 1 for a body that does not yield.
///   ours F_y r = 4/3 E* r^2 y^(3/2) r, there 2/5 (4/3 s E*) r^(1/2) r^(5/2), so s = 5/2 y^(3/2)
double wall_softening(const Body& body);

class LammpsLaw {
  public:
    /// `rolling`: false leaves rolling resistance out (two-body comparison).
    explicit LammpsLaw(const Scene& scene, bool rolling = true);

    /// What follows "pair_coeff I J ": materials as in EngineOptions (0 = A, 1 = B, 2 = fixed grains).
    std::string pair(int material_i, int material_j) const;
    /// What follows "fix ID GROUP wall/gran granular " or ".../region granular ": one grain material against
    /// the walls. Never adhesive: JKR walls take the distance of pull-off with the wrong sign. `softer`: its
    /// stiffness over that of the real wall.
    std::string wall(int material, bool frictionless = false, double softer = 1) const;

    bool adhesive() const { return adhesion_ > 0; }
    /// Softened E*, 8 G* of two materials, as our engine uses them.
    PairConstants constants(int a, int b) const { return constants_.at(a * 3 + b); }
    /// Scaled Gamma' [J/m2].
    double work_of_adhesion() const { return adhesion_; }

  private:
    std::string rest(const PairConstants& k, bool wall, bool frictionless) const;

    std::vector<PairConstants> constants_;
    Interaction interaction_;
    double adhesion_ = 0;
    bool rolling_ = true;
    double damping_number_ = 0, poissons_ratio_ = 0.3;
    double median_radius_ = 0, median_mass_ = 0;
};

/// Every way in which a LAMMPS run of a scene differs from ours on purpose or for want of a model, one
/// sentence each. `scene` is what ours ran (crosscheck_scene makes it as near as can be). `rigid_blade`:
/// LAMMPS's blade is as hard as the other walls.
std::vector<std::string> lammps_differences(const Scene& scene, bool rigid_blade = false);

}  // namespace gradwright
