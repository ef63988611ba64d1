// Where the energy of a run goes: an account beside the run, in double, kept only when asked for.
//
// Velocities stand at half steps, so a step moves the kinetic energy by force x mean velocity x time step,
// exactly. The account splits that work, contact by contact, from the forces the engine applied:
//   elastic part        stored, a function of the overlap (Hertz 2/5 F delta; JKR with the surface energy:
//                       F_s delta_s (2/5 s^10 - s^7 + 3/8 s^4), symbols of contact_law.h)
//   normal damping      what is left of the normal force
//   tangential spring   stored 1/2 S_t xi^2; sliding = spring force x the slip that Coulomb's cap took from
//   xi;
//                       tangential damping = what is left of the tangential force
//   rolling             moment x spin, less what `spring` stores
// Two terms are the law's own and have no force: `respring` (S_t follows the contact radius while xi stays,
// so the spring's energy changes by 1/2 xi^2 dS_t; also what a spring holds when its contact opens) and
// `bonds` (an adhesive contact is made at overlap 0 with the energy -9/40 F_s delta_s of its snap-on and torn
// off with what it still holds: together the hysteresis work). Energies are those of the half step after the
// last one; elastic energies of the force evaluation before it.
#pragma once

namespace gradwright {

/// [J]. Sums since the account was opened, by the first step of the engine.
struct EnergyLedger {
    bool open = false;
    long steps = 0;
    double work_of_bodies = 0;  ///< done by moving bodies on the grains
    double normal_damping = 0, tangential_damping = 0, sliding = 0, rolling = 0;
    double respring = 0;     ///< < 0: gained, see above
    double bonds = 0;        ///< adhesive contacts snapping on and tearing off
    double carried_off = 0;  ///< kinetic and potential energy of grains that left the run
    double start = 0;        ///< held when the account was opened
    // held now
    double kinetic = 0;
    double potential = 0;  ///< of gravity, zero at the origin
    double elastic = 0;    ///< normal, with the surface energy of adhesive contacts
    double springs = 0;    ///< tangential, and rolling ones of `spring`

    double held() const { return kinetic + potential + elastic + springs; }
    double dissipated() const {
        return normal_damping + tangential_damping + sliding + rolling + respring + bonds;
    }
    /// What came in and is neither held, dissipated nor carried off: 0 in a perfect account.
    double residual() const { return start + work_of_bodies - held() - dissipated() - carried_off; }
};

}  // namespace gradwright
