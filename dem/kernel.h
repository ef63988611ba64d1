// Inside of the engine: near-pair tiles, records and passes, once for each number type of the law. Private to
// dem/.
#pragma once
#include <array>

#include "dem/engine.h"

namespace gradwright {

/// Kernel-independent face of the tiles.
struct Engine::Kernel {
    struct Predicted {
        bool known = false;
        std::array<double, 3> velocity{}, spin{};
    };
    virtual ~Kernel() = default;
    virtual Predicted predicted(std::size_t i) const = 0;
    virtual void scale_motion(double factor) = 0;
    virtual void write_records() = 0;  ///< all grains, after anything but a step changed them
    virtual void rebuild_near() = 0;  ///< near pairs and wall slots from the candidates; history carried over
    virtual void
    carry_history() = 0;  ///< after rebuild_candidates: map kept contacts onto the new candidates
    virtual long run(long steps) = 0;  ///< steps done; ends early when the near list has run out
    virtual BodyForce force_on_body(int body) const = 0;
    virtual BodyForce force_on_fixed() const = 0;
    virtual std::size_t contacts() const = 0;
    virtual double coordination_sum() const = 0;
    virtual void forget_body(int body) = 0;
    virtual double max_overlap_ratio() const = 0;
    virtual std::size_t contacts_beyond(double ratio) const = 0;  ///< overlap / smaller radius
    virtual double memory_bytes() const = 0;
    virtual void remember_for_energy() = 0;  ///< what the step is going to change
    /// Books the step just done; `opening`: only what is held, nothing was seen of the way there.
    virtual void book_energy(EnergyLedger& ledger, bool opening) = 0;
};

template <class T>
struct Engine::KernelOf final : Engine::Kernel {
    static constexpr int W = Lane<T>::kWidth;
    using S = typename Lane<T>::Scalar;

    /// What the law gathers of a grain: 64 bytes, one cache line, for the wide law.
    struct Position {
        double x, y, z, r;
    };
    struct Motion {
        S vx, vy, vz, wx, wy, wz, r, spare;  ///< predicted for the coming whole step
    };
    /// W near pairs. i < n_dummy real; padding lanes point at two far dummies.
    struct alignas(32) PairTile {
        std::int32_t i[W], j[W];
        S radius[W], mass[W], e_star[W], g_star8[W], jkr_radius[W];
        S touching[W];
        S xi[3][W], roll[3][W];
        std::int32_t in_place[W];  ///< where the second grain's record goes
    };
    /// What a contact gives one grain: force, torque, 2 spare. 32 bytes for the wide law, so that a sum is
    /// one add a contact.
    struct alignas(8 * sizeof(S)) Record {
        S value[8];
    };
    struct alignas(32) WallTile {
        std::int32_t i[W], body[W];
        S radius[W], mass[W], e_star[W], g_star8[W], jkr_radius[W];
        S touching[W];
        S xi[3][W], roll[3][W];
        S out[6][W];
    };

    explicit KernelOf(Engine& engine) : e(engine) {}

    Engine& e;
    AlignedVector<Position> position;
    AlignedVector<Motion> motion;
    AlignedVector<PairTile> tiles, old_tiles;
    AlignedVector<WallTile> walls, old_walls;
    /// First grains' records in slot order, second grains' in order of the second grain: each grain reads two
    /// short runs of 32-byte records.
    AlignedVector<Record> own_record, in_record;
    std::vector<double> inverse_mass, inverse_inertia;
    std::size_t active_slots = 0,
                parked_slots = 0;  ///< parked: both ends asleep or fixed, history kept, not computed
    std::size_t wall_slots = 0;
    std::vector<std::int32_t>
        own_first;  ///< slots in which grain i is the first: own_first[i] .. own_first[i+1]
    std::vector<std::int32_t> in_first;
    std::vector<std::int32_t> wall_first;
    std::vector<std::uint8_t> keep;  ///< per candidate: 1 active, 2 parked
    std::vector<std::int32_t> park_first;

    void write_records() override;
    Predicted predicted(std::size_t i) const override;
    void scale_motion(double factor) override;
    void rebuild_near() override;
    void rebuild_walls();
    void carry_history() override;
    long run(long steps) override;
    template <bool kAdhesive, RollingModel kRolling>
    void pair_pass(std::size_t first, std::size_t last);
    template <bool kAdhesive, RollingModel kRolling>
    void wall_pass(std::size_t first, std::size_t last, double body_time);
    template <bool kAdhesive, RollingModel kRolling>
    long run_with(long steps);
    double grain_pass(std::size_t first, std::size_t last, double kick, double frame);

    std::size_t pair_count() const { return active_slots; }
    BodyForce force_on_body(int body) const override;
    BodyForce force_on_fixed() const override;
    std::size_t contacts() const override;
    double coordination_sum() const override;
    void forget_body(int body) override;
    template <class Visitor>
    void for_each_overlap(Visitor&& visit) const;
    double max_overlap_ratio() const override;
    std::size_t contacts_beyond(double ratio) const override;
    double memory_bytes() const override;
    template <class Archive>
    void archive(Archive& to);

    /// The run before the step that is booked; filled only with `energy_account`.
    struct Before {
        AlignedVector<PairTile> tiles;
        AlignedVector<WallTile> walls;
        State state;
        AlignedVector<Motion> motion;
        std::vector<Motion> earlier;  ///< predicted motion one step before, by grain number
        double body_time = 0, earlier_body_time = 0;
    } before;
    void remember_for_energy() override;
    void book_energy(EnergyLedger& ledger, bool opening) override;
};

}  // namespace gradwright
