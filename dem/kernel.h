// Inside of the engine: near-pair tiles, records and passes, once for each number type of the law. Private to
// dem/.
//
// One sweep a step. Grains stand in cell order, x slowest, and a pair belongs to its first, lower grain. So
// once the pairs of a block of grains are computed, nothing that comes later in the order adds to its grains
// or reads where they were, and they can be summed and moved at once, while all of it is still in the cache:
// only the width of the moving window, two layers of cells, has to fit there. The records by which a pair
// hands its force over never leave it: first grains' records live for one block, second grains' in a ring as
// long as the window. On several threads each has a run of blocks; pairs that reach over its end are computed
// by all threads first (the tail), then all sweep. A grain's sum always runs over the same slots in the same
// order: the same bits on any number of threads. Measured against the same work in two passes over all grains
// with the records in memory between them, `bench --grains 20000 --threads 1 --threads 2 --state settled
// --state flowing`: million grain-steps/s settled 13.0 against 11.5 on one core and 36.2 against 29.8 on two,
// flowing 21.8 against 15.7 on two.
#pragma once
#include <array>
#include <vector>

#include "dem/engine.h"

namespace gradwright {

/// Largest sum of two wide reaches, in candidate skins: what a cell must hold beside two grains.
inline constexpr double kWidestReach = 1.5;

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
    virtual void restored() = 0;             ///< what is not saved follows from what is
    virtual void remember_for_energy() = 0;  ///< what the step is going to change
    /// Books the step just done; `opening`: only what is held, nothing was seen of the way there.
    virtual void book_energy(EnergyLedger& ledger, bool opening) = 0;
};

template <class T>
struct Engine::KernelOf final : Engine::Kernel {
    static constexpr int W = Lane<T>::kWidth;
    using S = typename Lane<T>::Scalar;

    /// What the law gathers of a grain: 64 bytes, one cache line, for the wide law.
    struct alignas(32) Position {
        double x, y, z, r;
    };
    struct alignas(4 * sizeof(S)) Motion {
        S vx, vy, vz, r, wx, wy, wz, spare;  ///< predicted for the coming whole step
    };
    /// Half-step velocities and what turns a force into their change; copied back to the State when a run of
    /// steps ends.
    struct Moving {
        D4 v;  ///< vx, vy, vz [m/s], 1/m [1/kg]
        D4 w;  ///< wx, wy, wz [rad/s], 1/I [1/(kg m2)]
    };
    /// W near pairs. i < n_dummy real; padding lanes point at two far dummies.
    struct alignas(32) PairTile {
        std::int32_t i[W], j[W];
        S radius[W], mass[W], e_star[W], g_star8[W], jkr_radius[W];
        S touching[W];
        S xi[3][W];
        std::int32_t in_place[W];  ///< where in `ring` the second grain's record goes
    };
    /// Rolling springs of W near pairs, beside their tile; none where the rolling model has no springs.
    struct alignas(32) RollTile {
        S angle[3][W];
    };
    /// What a contact gives one grain: force, 0, torque, 0. 32 bytes for the wide law, so that a sum is one
    /// add a contact.
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

    /// A fixed run of grains in cell order: its pairs and wall contacts begin on tiles of their own.
    static constexpr std::size_t kBlock = 128;
    struct Block {
        std::int32_t first_tile = 0, end_tile = 0, first_wall = 0, end_wall = 0;
        std::int32_t own_end = 0, wall_end = 0;       ///< slots behind the last grain's
        std::int32_t first_awake = 0, end_awake = 0;  ///< into Engine::awake_
        std::int32_t reach = -1;                      ///< highest second grain of its pairs
    };
    /// What one thread sweeps: blocks [first, end), of which [tail, end) have pairs that reach beyond `end`.
    struct Share {
        std::int32_t first = 0, tail = 0, end = 0;
        std::int32_t ring = 0;        ///< its part of `ring`: kept modulo ring_mask + 1 ...
        std::int32_t tail_ring = 0;   ///< ... and in full for the grains of the tail,
        std::int32_t tail_place = 0;  ///< whose places begin here
        std::int32_t spill = 0;       ///< takes what padding lanes write
        std::int32_t own = 0;         ///< its part of `own_record`: one block, ...
        std::int32_t tail_own = 0;    ///< ... then the tail's
    };

    explicit KernelOf(Engine& engine)
        : e(engine),
          has_rolls(engine.options_.interaction.rolling_friction > 0 &&
                    engine.options_.interaction.rolling_model == RollingModel::spring) {}

    Engine& e;
    const bool has_rolls;
    AlignedVector<Position> position;
    AlignedVector<Motion> motion;
    AlignedVector<Moving> moving;
    AlignedVector<PairTile> tiles, old_tiles;
    AlignedVector<RollTile> rolls, old_rolls;
    AlignedVector<WallTile> walls, old_walls;
    AlignedVector<Record> own_record, ring;
    std::int32_t ring_mask = 0;
    std::size_t active_slots = 0,
                parked_slots = 0;         ///< parked: both ends asleep or fixed, history kept, not computed
    std::size_t wall_slots = 0;           ///< as active_slots with the padding at the blocks' ends
    std::vector<std::int32_t> own_first;  ///< slots in which grain i is the first begin here
    std::vector<std::int32_t> in_first;   ///< places in which grain i is the second: in_first[i] .. [i+1]
    std::vector<std::int32_t> wall_first;
    std::vector<std::uint8_t> keep;  ///< per candidate: 1 active, 2 parked
    std::vector<std::int32_t> park_first;
    std::vector<Block> blocks;
    std::vector<Share> shares;
    std::vector<std::array<double, 3>> force_on_fixed_by_block;  ///< of the last step [N]

    void write_records() override;
    void write_moving();
    /// Who sweeps what, and where second grains' records go, for the pairs as they stand.
    void share_out();
    Predicted predicted(std::size_t i) const override;
    void scale_motion(double factor) override;
    void rebuild_near() override;
    void rebuild_walls();
    void carry_history() override;
    long run(long steps) override;
    template <bool kAdhesive, RollingModel kRolling>
    void pair_pass(std::size_t first, std::size_t last, Record* own);
    template <bool kAdhesive, RollingModel kRolling>
    void wall_pass(std::size_t first, std::size_t last, double body_time);
    template <bool kAdhesive, RollingModel kRolling>
    long run_with(long steps);
    /// Sums, motion and predicted motion of a block's awake grains. `own`: by slot; `second`: by place,
    /// modulo `mask` + 1. Returns the largest (speed against `frame` / reach)^2 [1/s2]; infinite when it is
    /// no number.
    double grain_pass(const Block& block, const Record* own, const Record* second, std::int32_t mask,
                      double kick, D4 frame);
    std::array<double, 3> force_on_fixed_of(const Block& block, const Record* own) const;

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
    void restored() override;

    /// The run before the step that is booked; filled only with `energy_account`.
    struct Before {
        AlignedVector<PairTile> tiles;
        AlignedVector<RollTile> rolls;
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
