// Inside of the engine: near-pair tiles, records and passes, once for each number type of the law. Private to
// dem/.
//
// One sweep a step. Grains stand in cell order, the bed's longer side slowest, and a pair belongs to its
// first, lower grain. So once the pairs of a block of grains are computed, nothing that comes later in the
// order adds to its grains or reads where they were, and they can be moved at once, while all of it is still
// in the cache: only the width of the moving window, a layer of cells or two, has to fit there. A pair adds
// what it does to the sums of both its grains, so that a grain's sum runs over its pairs in the order of
// their slots, whoever computed them. On several threads each has a run of blocks; pairs of blocks that reach
// over its end (the tail) are computed by all threads first and kept: what they do beyond the end is the
// first that is added there, what they do within it waits until the sweep comes by. The same order, the same
// bits on any number of threads. A bed that does not fit in the processor's cache is swept by several steps
// at once, one close behind the other (run_in_levels): it comes from memory once for all of them. Rejected:
// records by which a pair hands its force over, summed grain by grain. A grain has from none to a dozen,
// which the processor cannot foresee: sums and motion took 17 ns a grain-step, motion alone takes 4.
#pragma once
#include <omp.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "dem/engine.h"

namespace gradwright {

/// Largest sum of two wide reaches, in candidate skins: what a cell must hold beside two grains.
inline constexpr double kWidestReach = 1.5;
/// Longest near reach, in those of a typical grain: a fast grain that strikes a slow one makes it use up its
/// reach so much faster than any did before.
inline constexpr double kLongestReach = 4;

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
    virtual int steps_at_once() const = 0;
    virtual long run(long steps) = 0;  ///< steps done; ends early when the near list has run out
    virtual BodyForce force_on_body(int body) const = 0;
    virtual BodyForce force_on_fixed() const = 0;
    virtual std::size_t contacts() const = 0;
    virtual std::size_t near_pairs() const = 0;
    virtual double coordination_sum() const = 0;
    virtual void forget_body(int body) = 0;
    virtual Overlaps overlaps(double rule) const = 0;
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

    /// What the law gathers of a grain beside its place.
    struct alignas(8 * sizeof(S)) Motion {
        S vx, vy, vz, r, wx, wy, wz, spare;  ///< predicted for the coming whole step
    };
    /// W near pairs. i < n_dummy real; padding lanes point at two far dummies.
    struct alignas(64) PairTile {
        std::int32_t i[W], j[W];
        S radius[W], mass[W], e_star[W], g_star8[W], jkr_radius[W];
        S touching[W];
        S xi[3][W];
    };
    /// Rolling springs of W near pairs, beside their tile; none where the rolling model has no springs.
    struct alignas(64) RollTile {
        S angle[3][W];
    };
    /// What contacts give one grain: force, 0, torque, 0. 32 bytes for the wide law, so that a sum is one add
    /// a contact.
    struct alignas(8 * sizeof(S)) Record {
        S value[8];
    };
    /// What a tile's pairs do, before it is added.
    struct alignas(64) Handed {
        Record to_first[W], to_second[W];
        bool idle;  ///< nothing touches: the records are not filled
    };
    struct alignas(64) WallTile {
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
        std::int32_t own_end = 0, wall_end = 0;  ///< slots behind the last grain's
        std::int32_t own_touching = 0;           ///< of its pairs, those that touched when the list was made
        std::int32_t own_parked = 0;             ///< its first parked pair, of all of them
        std::int32_t first_awake = 0, end_awake = 0;  ///< into Engine::awake_
        std::int32_t reach = -1;                      ///< highest second grain of its pairs
        std::uint8_t presses_still = 0;  ///< 1: some pair or wall acts on a grain of it that does not move
    };
    /// What one thread sweeps: blocks [first, end), of which [tail, end) are those whose pairs are computed
    /// before the sweep and kept from `kept` on.
    struct Share {
        std::int32_t first = 0, tail = 0, end = 0;
        std::int32_t kept = 0;
        std::int32_t reach = -1;         ///< highest second grain of its tail's pairs
        double cost = 0, tail_cost = 0;  ///< of its blocks, of its tail, as share_out() reckons them
    };
    /// How long a share took in some steps: its tail, and the sweep [s].
    struct Busy {
        double tail = 0, sweep = 0;
    };

    explicit KernelOf(Engine& engine)
        : e(engine),
          has_rolls(engine.options_.interaction.rolling_friction > 0 &&
                    engine.options_.interaction.rolling_model == RollingModel::spring) {}

    Engine& e;
    const bool has_rolls;
    AlignedVector<Motion> motion;
    AlignedVector<PairTile> tiles;
    AlignedVector<RollTile> rolls;
    AlignedVector<WallTile> walls, old_walls;
    /// What the pairs of one share give its grains. Alive are only the sums of those from the block that is
    /// swept to the furthest that its pairs have met: each stands where its number falls in a ring of
    /// 2^k places, which stays in the cache. Zero between steps.
    struct Sums {
        Record* ring;
        std::int32_t mask;  ///< 2^k - 1
        Record& operator[](std::int32_t grain) const { return ring[grain & mask]; }
    };
    AlignedVector<Record> sums;  ///< the rings, one after the other
    std::int32_t sums_mask = 0;
    AlignedVector<S> springs;  ///< of what touches, while the near list is made anew
    /// Of a tile of the near list before: which of its pairs touched, and how many did in the tiles ahead of
    /// it.
    struct TileBefore {
        std::int32_t first;
        std::uint32_t touched;
    };
    std::vector<TileBefore> tiles_before;
    AlignedVector<Handed> kept;  ///< of the tails, tile by tile
    std::size_t active_slots = 0,
                parked_slots = 0;  ///< parked: both ends asleep or fixed, history kept, not computed
    std::size_t wall_slots = 0;    ///< as active_slots with the padding at the blocks' ends
    std::vector<std::int32_t> wall_first;
    std::vector<Block> blocks;
    std::vector<Share> shares;
    /// Of each share's thread, in all it does and in its tail alone: cost over time, against the mean of all.
    std::vector<double> pace, tail_pace;
    std::vector<std::array<double, 3>> force_on_fixed_by_block;  ///< of the last step [N]

    void write_records() override;
    /// Who sweeps what, for the pairs as they stand. Shares are cut so that all threads end together, by how
    /// fast each was: cores differ, and others use them too.
    void share_out();
    /// Rings, one a share or one a level of each thread, all zero.
    void make_sums();
    /// Whether steps are swept several at once, and how many by each thread.
    void choose_levels();
    /// The last block that the pairs of block `b` reach into.
    std::int32_t last_met(std::int32_t b) const {
        return std::max(b, blocks[b].reach / static_cast<std::int32_t>(kBlock));
    }
    Sums sums_of(std::size_t ring) {
        return {sums.data() + ring * (static_cast<std::size_t>(sums_mask) + 1), sums_mask};
    }
    void learn_pace(const std::vector<Busy>& busy);
    Predicted predicted(std::size_t i) const override;
    void scale_motion(double factor) override;
    void rebuild_near() override;
    /// Leaves `tiles_before` and, in `springs`, those of what touches: the tiles may be overwritten.
    void keep_springs();
    /// `work(block)` for every block, if possible on the thread that sweeps it: its pairs stay in that core's
    /// cache. Blocks in which all sleep, and what is left in the end, go to whoever has time.
    template <class Work>
    void on_own_thread(Work&& work);
    /// What becomes of every candidate, and how many pairs of a kind each block has. `signed_reach`: of each
    /// grain, < 0 where it stands still.
    void sort_candidates(const std::vector<float>& signed_reach);
    /// The pairs and what they remember into the tiles.
    void fill_tiles(const std::vector<float>& signed_reach);
    /// Which grain of the block each of its candidates belongs to; stands until the thread asks again.
    const std::uint8_t* owners(std::size_t block) const;
    /// What the first `lanes` pairs of a tile are made of, from their grains.
    void write_constants(PairTile& tile, int lanes);
    int numbers_per_spring() const { return has_rolls ? 6 : 3; }  ///< tangential, then rolling
    void rebuild_walls();
    void carry_history() override;
    long run(long steps) override;
    /// What a sweep asks of the memory while it computes, where the grains do not fit in the cache: with
    /// every tile an equal part of what comes next (time_step.cpp). The wide law alone does so.
    struct Ahead {
        std::int32_t met = 0, met_end = 0;  ///< grains that the pairs of the next blocks will meet first
        std::int32_t own = 0, own_end = 0;  ///< grains of the next block
        std::int32_t met_each = 0, own_each = 0;
    };
    /// Where `ahead` is to get to during block `b` of a share whose tail begins at `tail`.
    void aim(Ahead& ahead, std::int32_t b, std::int32_t tail) const;
    void fetch_grains(Ahead& ahead) const;
    /// Grains of the next share that a tail's pairs meet, and their sums: the tail reads the one and adds to
    /// the other, then their own thread writes both.
    void fetch_met(std::int32_t first, std::int32_t last, const Sums& of, bool reading) const;
    /// One half of a tile some way on: its pairs and constants, or what they remember.
    void fetch_tile(std::int32_t tile, bool second_half) const;
    /// The block's pairs; what they do is added to the sums, or with `kept` left there, a tile each.
    template <bool kAdhesive, RollingModel kRolling>
    void pair_pass(const Block& block, const Sums& to, Handed* kept, Ahead* ahead);
    template <bool kAdhesive, RollingModel kRolling>
    void wall_pass(const Block& block, const Sums& to, double body_time);
    /// What one step of a run needs to know of itself.
    struct Step {
        double kick;       ///< what velocities are advanced by [s]
        double body_time;  ///< bodies stand where they stand then [s]
        bool last;         ///< of the run: the forces on fixed grains are kept
    };
    /// What all steps of a run have in common.
    struct Run {
        const Engine& e;
        const long steps;
        const double start = omp_get_wtime(), dt = e.options_.time_step, body_time = e.body_time_;
        const bool first_kick = e.first_kick_;
        const D4 frame = {e.frame_[0], e.frame_[1], e.frame_[2], 0};
        const double body_top = e.body_speed();
        /// Of what does not move by itself: share of its reach used up in a second [1/s].
        const double rest_rate = std::max(e.still_rate_, e.body_reach_ > 0 ? body_top / e.body_reach_ : 0);
        double law_seconds = 0, grain_seconds = 0;  ///< in the steps or blocks that were looked at
        long late = 0;                              ///< steps begun when the near list had run out
        Step step(long number) const {
            return {first_kick && number == 0 ? 0.5 * dt : dt,
                    body_time + (e.bodies_move_ ? dt * static_cast<double>(number) : 0), number == steps - 1};
        }
        /// Of its reach, what the grain that uses up most of it does in a step; `top` as of grain_pass.
        double share(double top) const { return dt * std::max(std::sqrt(top), rest_rate); }
    };
    /// All of a block that follows its pairs: walls, then motion. Returns as grain_pass does; `lap` is called
    /// between the two.
    template <bool kAdhesive, RollingModel kRolling, class Lap>
    double finish_block(std::int32_t block, const Sums& sums, const Step& step, D4 frame, Lap&& lap);
    /// Steps by shares, or several steps at once: the same bits.
    template <bool kAdhesive, RollingModel kRolling>
    long run_with(long steps);
    template <bool kAdhesive, RollingModel kRolling>
    long run_in_levels(long steps);
    /// More grains move than fit in the cache.
    bool beyond_cache() const { return static_cast<int>(e.awake_.size()) > e.options_.cached_grains; }
    /// Steps to go before the near list is looked at again: one, or beyond the cache so many that it lasts
    /// even if grains use up their reaches four times as fast meanwhile; if still faster, the steps are
    /// counted (Engine::late_steps). `step_share`: what the last step used of it.
    long steps_between_looks(double travel, double step_share) const;
    /// Clocks and counters after `done` steps of a run.
    void book_run(const Run& run, long done, double travel);
    int levels = 0;  ///< steps at once that each thread sweeps; 0: one after the other, by shares
    int steps_at_once() const override { return levels > 0 ? levels * e.threads_ : 1; }
    /// The first `lanes` pairs of a tile to the sums of their grains.
    static void hand_over(const PairTile& tile, const Handed& handed, int lanes, const Sums& to) {
        using Sum = typename Lane<T>::Sum;
        for (int lane = 0; lane < lanes; ++lane) {
            *reinterpret_cast<Sum*>(&to[tile.i[lane]]) +=
                *reinterpret_cast<const Sum*>(&handed.to_first[lane]);
            *reinterpret_cast<Sum*>(&to[tile.j[lane]]) +=
                *reinterpret_cast<const Sum*>(&handed.to_second[lane]);
        }
    }
    /// What the kept pairs of a block do to grains beyond `end`, or to those before it.
    void hand_over_kept(const Block& block, const Handed* from, const Sums& to, std::int32_t end,
                        bool beyond);
    /// Motion and predicted motion of a block's awake grains from their sums, which become zero. Returns the
    /// largest (speed against `frame` / reach)^2 [1/s2]; infinite when it is no number.
    double grain_pass(const Block& block, const Sums& from, double kick, D4 frame);
    std::array<double, 3> force_on_fixed_of(const Block& block, const Sums& from) const;
    std::int32_t first_grain(std::int32_t block) const {
        return std::min(static_cast<std::int32_t>(e.state_.size()),
                        block * static_cast<std::int32_t>(kBlock));
    }

    BodyForce force_on_body(int body) const override;
    BodyForce force_on_fixed() const override;
    std::size_t contacts() const override;
    std::size_t near_pairs() const override;
    double coordination_sum() const override;
    void forget_body(int body) override;
    template <class Visitor>
    void for_each_overlap(Visitor&& visit) const;
    Overlaps overlaps(double rule) const override;
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
