// The engine: grains and bodies in, motion out. One instance is one run; nothing is global.
// A step reads as named stages: touching pairs and walls -> contact law -> sums per grain -> integrate (->
// refresh lists if moved).
//
// Two lists: candidates within `skin` (rebuilt with the cell order) and, of those, the near pairs within
// `near_skin` (several times as often), which are what the law sees; both skins are what a pair of typical
// grains gets, fast ones get more (reach.cpp). A near pair keeps its place between
// refreshes, so that the law reads and writes its history in place and one grain's sums run over fixed slots
// in fixed order: same bits on any number of threads, no atomic sums. (Measured alternative: test all
// candidates every step and compress, see contact_list.cpp.)
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include "dem/boundary.h"
#include "dem/contact_law.h"
#include "dem/energy_ledger.h"
#include "dem/material.h"
#include "dem/scene.h"
#include "dem/state.h"

namespace gradwright {

struct EngineOptions {
    std::vector<Material> materials;  ///< index used by grains and bodies; youngs_modulus = infinity is rigid
    Interaction interaction;
    double softening = 1;  ///< E' = s E; with `cohesion_number` Gamma' = Gamma s^(2/5)
    AdhesionScaling adhesion_scaling = AdhesionScaling::cohesion_number;
    double time_step = 0;                           ///< [s], > 0
    std::array<double, 3> gravity = {0, 0, -9.81};  ///< [m/s2]
    double period_y = 0;                            ///< [m], 0 = not periodic
    double period_x = 0,
           period_z = 0;  ///< [m], for a gas without walls (small: one cell each); with period_y
    Precision precision = Precision::single_law;
    bool sleep = false;
    double sleep_speed = 0.5e-3;  ///< grains slower than this ... [m/s]
    double sleep_time = 0.3e-3;   ///< ... for so long, with neighbours alike, fall asleep [s]
    double wake_speed = 1.0e-3;   ///< an awake near neighbour faster than this wakes a sleeper [m/s]
    double skin = 0;              ///< candidate skin of two typical grains [m], 0 = from the grain size
    double near_skin = 0;         ///< near-pair skin of two typical grains [m], 0 = from the grain size
    int threads = 0;              ///< 0 = OpenMP's default
    /// More grains than this do not fit in the processor's cache: memory is asked ahead, and when so many are
    /// awake several steps are computed at once (time_step.cpp). The end of a list of pairs is then looked
    /// for every few steps, on any number of threads; steps that it came too late for are counted
    /// (`late_steps`), and but for these the bits are the same.
    int cached_grains = 40000;
    double speed_limit = 20;       ///< faster grains mean the run has diverged [m/s]
    double remove_beyond_x = 1e9;  ///< grains past this x leave the run (overflow) [m]
    bool energy_account = false;   ///< keep an EnergyLedger: several times slower; not with `sleep`
    LawFault fault;
};

struct GrainSpec {
    double x = 0, y = 0, z = 0, vx = 0, vy = 0, vz = 0, wx = 0, wy = 0, wz = 0;
    double radius = 0;
    int material = 0;
    bool fixed = false;
};

/// Numbers of one material pair, softened.
struct PairConstants {
    double e_star = 0, g_star8 = 0;  ///< E*, 8 G* [Pa]
};

struct EngineTimes {
    double law = 0, grains = 0, near_list = 0, candidates = 0;  ///< [s] wall
    long near_lists = 0, candidate_lists = 0;                   ///< made so far
};

/// Force of all grains on one body or on the fixed grains [N].
struct BodyForce {
    double x = 0, y = 0, z = 0;
};

class Engine {
  public:
    explicit Engine(const EngineOptions& options);
    ~Engine();
    Engine(const Engine&) = delete;
    Engine& operator=(const Engine&) = delete;

    /// Returns the grain's id (0, 1, ... in order of adding).
    int add_grain(const GrainSpec& grain);
    int add_body(const Body& body);
    void remove_body(int body);  ///< its contacts end; other bodies keep their numbers
    /// The body stands elsewhere from here on; same kind. `carried`: with all that touches it, which keeps
    /// its springs; else its contacts end. A run restored from later on needs the body as it stands then.
    void move_body(int body, const Body& to, bool carried);
    /// Remove mobile grains by id (levelling, overflow).
    void remove_grains(const std::function<bool(std::size_t index)>& predicate);
    /// Give grain index i another material: its mass and its contacts' constants change, its springs stay.
    void set_material(std::size_t i, int material);
    /// After changing materials, radii or positions from outside: contacts keep their springs where they
    /// persist.
    void refresh();
    void wake_all();
    /// Sleep on or off from here on; grains that sleep go on sleeping.
    void allow_sleep(bool allowed) { options_.sleep = allowed; }
    /// Multiply every velocity and spin (a quench while packing).
    void scale_velocities(double factor);

    /// Up to `steps` steps; fewer when something went wrong (see `failed`). Returns the number done.
    long advance(long steps);

    const State& state() const { return state_; }
    State& state() { return state_; }
    const std::vector<Body>& bodies() const { return bodies_; }
    double body_shift_x(int body) const { return bodies_[body].speed_x * body_time_; }
    double time() const { return time_; }
    long steps() const { return steps_; }
    double grain_steps() const { return grain_steps_; }
    /// Of the steps, those whose near pairs were of a list that had run out, so that some contact may have
    /// been noticed late. Only beyond the cache, where grains became many times as fast within a few steps.
    long late_steps() const { return late_steps_; }
    double time_step() const { return options_.time_step; }
    double sleep_time() const { return options_.sleep_time; }  ///< [s]
    const EngineTimes& times() const { return times_; }
    std::size_t mobile() const;
    std::size_t awake() const { return awake_.size(); }
    /// Velocity of grain index i at the last whole step, predicted [m/s].
    std::array<double, 3> velocity(std::size_t i) const;
    std::array<double, 3> spin(std::size_t i) const;
    double max_speed() const;       ///< over mobile grains [m/s]
    double kinetic_energy() const;  ///< [J]
    double max_overlap_ratio();     ///< overlap / smaller radius now, over near pairs and walls
    double max_overlap_ratio_seen() const { return overlaps_seen_.largest; }
    /// Of the contacts seen whenever lists were made from scratch, those beyond kOverlapRule [-]. Grains that
    /// sleep count, faces that yield do not; lists are made as grains travel, so that quiet times count
    /// little. Since the first step, whatever was moved by hand in between. 0 before it.
    double deep_contact_share() const {
        return overlaps_seen_.contacts > 0 ? overlaps_seen_.beyond / overlaps_seen_.contacts : 0;
    }
    /// Share of mobile grains in a contact whose overlap exceeds `ratio` of the smaller radius now [-].
    double share_overlapping(double ratio);
    double mean_coordination();    ///< contacts per mobile grain (floor and walls counted once)
    std::size_t contacts() const;  ///< pair contacts alive
    /// Steps that the grains go through together, on all threads: more than 1 for a bed beyond the cache, on
    /// several threads only beyond a few times as much.
    int steps_at_once() const;
    std::size_t near_pairs() const;  ///< pairs that the law sees in every step, touching or not
    /// Grain indices whose overlap with a body exceeds `ratio` of their radius now.
    std::vector<std::size_t> overlapping_body(int body, double ratio) const;
    BodyForce force_on_body(int body) const;  ///< of the last force evaluation
    BodyForce force_on_fixed() const;
    double memory_bytes() const;
    /// "" while sound, else what went wrong: "speed" or "not finite".
    const std::string& failed() const { return failed_; }
    std::string state_hash() const;  ///< of ids, positions and velocities, independent of the storage order
    PairConstants pair_constants(int a, int b) const {
        return pairs_[a * static_cast<int>(options_.materials.size()) + b];
    }
    double work_of_adhesion() const { return adhesion_; }  ///< scaled Gamma' [J/m2]
    int threads() const { return threads_; }
    /// Everything the next step reads, as bytes of this program on this kind of machine; not with
    /// `energy_account`.
    std::string save();
    /// Onto an engine with the same options and bodies (threads may differ) and any grains: advanced in the
    /// same portions the run goes on with the bits it would have had (the bodies' clock is summed portion by
    /// portion). Throws std::invalid_argument for bytes of another run, cut short or damaged.
    void restore(const std::string& saved);
    const EnergyLedger& energy() const { return energy_; }  ///< zeros without `energy_account`

    /// Bodies stand still until this instant counts: their shift is speed x (time since).
    void start_bodies() {
        body_time_ = 0;
        bodies_move_ = true;
    }
    void stop_bodies() { bodies_move_ = false; }

  private:
    struct Kernel;
    template <class T>
    struct KernelOf;

    template <class Archive>
    void archive(Archive& to);
    std::string options_text() const;  ///< hash of what a saved run must agree with
    void rebuild_candidates();
    void find_reachable_bodies();
    void update_sleep();
    /// Two things close in by no more than the sum of their ways against any common frame. Taken is the mean
    /// motion of the grains that are awake, so that a heap that is pushed along, or a bed that falls, counts
    /// by what moves within it.
    void choose_frame();
    /// How far each thing may go against the frame before the near list is made anew (dem/reach.cpp). False
    /// when the candidates leave some too little room.
    bool choose_reach();
    void choose_wide_reach();   ///< how far before the candidates are
    double body_speed() const;  ///< largest speed of a body against the frame [m/s]
    void check_health();
    long step_with_account();  ///< one step, booked in `energy_`
    void book_leaving_grains();

    EngineOptions options_;
    State state_;
    std::vector<Body> bodies_;
    std::vector<std::uint8_t> body_removed_;
    std::vector<PairConstants> pairs_;
    LawConstants law_;
    double adhesion_ = 0;
    double skin_ = 0, near_skin_ = 0, largest_radius_ = 0, smallest_radius_ = 1e9;
    int threads_ = 1;
    double time_ = 0, body_time_ = 0;
    bool bodies_move_ = false;
    long steps_ = 0, late_steps_ = 0;
    double grain_steps_ = 0;
    std::array<double, 3> frame_{};        ///< velocity of the frame [m/s]
    std::array<double, 3> frame_shift_{};  ///< its way since the candidates were found [m]
    double typical_speed_ = 0;             ///< rms against the frame of the grains that are awake [m/s]
    double body_way_ = 0;  ///< of bodies against the frame since the candidates were found [m]
    double body_reach_ = 0, wide_body_reach_ = 0;  ///< of bodies [m]
    double still_rate_ = 0;  ///< of fixed and sleeping grains: share of their reach used up in a second [1/s]
    /// Steps, at the speeds that the near list was made for; decides who sweeps what and so no bits, not
    /// saved.
    double list_lasts_ = 0;
    double travel_ = 0;  ///< largest share of a reach used up since the near list was made; 1 ends it
    long steps_since_near_ = 0;
    bool lists_valid_ = false, first_kick_ = true;
    /// Overlaps over the smaller radius, of pairs and of walls that do not yield.
    struct Overlaps {
        double largest = 0, contacts = 0, beyond = 0;  ///< [-]; numbers of contacts, of those beyond a rule
    };
    Overlaps overlaps_seen_;
    std::string failed_;
    EngineTimes times_;
    EnergyLedger energy_;

    // by grain [m]; as 1/reach^2 what the step reads
    std::vector<float> reach_, wide_reach_, inverse_reach2_;

    // candidate list, in cell order
    std::array<double, 3> built_from_{};       ///< where the grains stood then: from this corner [m], ...
    std::vector<std::array<float, 3>> built_;  ///< ... in float,
    double built_error_ = 0;                   ///< so far off at most
    std::vector<std::int32_t> candidate_first_, candidate_, candidate_slot_;
    std::vector<std::uint32_t> reachable_;  ///< bodies within the skin of a grain, one bit each
    std::vector<std::uint8_t> wakeable_;    ///< 1: a moving body may come near enough to wake it
    std::vector<std::int32_t> new_index_;   ///< of the last permutation: old index -> new index, -1 removed
    std::vector<std::int32_t> awake_;
    std::int32_t next_id_ = 0;

    std::unique_ptr<Kernel> kernel_;
};

}  // namespace gradwright
