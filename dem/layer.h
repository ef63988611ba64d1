// What one spread leaves: every laid grain with where it lies, where it came from, and what it carried.
#pragma once
#include <cstdint>
#include <limits>
#include <span>
#include <string>
#include <vector>

namespace gradwright {

/// State of a run. `ok` or a named physical failure with the knob to turn.
struct RunHealth {
    std::string status = "not_run";  ///< ok | diverged | jammed | does_not_flow | starved | not_settled |
                                     ///< overlap | interrupted
    std::string reason;              ///< one sentence, with the knob to turn
    double max_overlap_ratio = 0;    ///< max overlap / smaller radius seen [-]
    /// Of the contacts seen, those beyond kOverlapRule [-] (Engine::deep_contact_share); NaN: nobody looked
    double deep_contact_share = std::numeric_limits<double>::quiet_NaN();
    std::vector<std::string> warnings;
    bool ok() const { return status == "ok"; }
};

/// Laid grains of one spread: mobile grains whose centre is over the platform and below z = 0 at the end.
/// One entry per grain in every vector. Frames: origin in the dispenser (x from 0), after levelling, before
/// the pass; deposit_x from the platform's near edge; both y unwrapped, so deposit_y - origin_y is the
/// lateral way.
struct Layer {
    std::vector<double> origin_x, origin_y, origin_z;     ///< [m]
    std::vector<double> deposit_x, deposit_y, deposit_z;  ///< [m]
    std::vector<double> volume;                           ///< [m3]
    std::vector<double> radius;                           ///< [m]
    std::vector<std::uint8_t> is_a;  ///< label carried in the run; all 0 when not labelled
    bool labelled = false;           ///< true: A and B had their own density, stiffness and size in the state
    bool periodic = true;            ///< y periodic with `width`
    double width = 0;                ///< modelled width W [m]
    double dispenser_length = 0, platform_length = 0, gap = 0;  ///< [m]
    double dosed_solid_volume = 0;                              ///< solid above z = 0 at the start [m3]
    double overflow_solid_volume = 0;                           ///< solid beyond the platform at the end [m3]
    double overflow_solid_volume_a = 0;                         ///< of it A (0 when not labelled) [m3]
    double bed_packing = 0;                                     ///< packing fraction of the settled bed [-]
    std::uint64_t packing_seed = 0;

    std::size_t size() const { return volume.size(); }
    double solid_volume() const;  ///< [m3]
    /// f = solid laid / solid dosed [-]
    double capture_fraction() const;
    /// Solid volume below z = 0 over gap x area [-]
    double packing_fraction() const;
};

/// Several layers of one run as one: all their grains, sums of doses and overflows; `gap` is the sum of
/// theirs, so that packing_fraction() is the share of all their room. Not empty.
Layer pooled(std::span<const Layer> layers);

/// Positions and velocities of every mobile grain at one instant, for pictures, VTK and the heap's measures
/// (heap.h).
struct Snapshot {
    double time = 0, blade_x = 0;        ///< [s], [m]
    std::vector<float> x, y, z, radius;  ///< [m], scene frame
    std::vector<std::uint8_t> is_a;
    std::vector<float> vx, vy, vz;  ///< [m/s]
};

}  // namespace gradwright
