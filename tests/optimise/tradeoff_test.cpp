// Speed against error, on levels whose true error is known: the synthetic heap with a centre that only large
// grains move, and hand-made tables.
#include "optimise/tradeoff.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "optimise/study_file.h"
#include "tests/optimise/synthetic_heap.h"

namespace gradwright {
namespace {

using testing::Contains;
using testing::HasSubstr;
using testing::Not;
using testing_heap::Calls;
using testing_heap::Heap;

const std::string kStudy = R"([machine]
use = "coupon-rig"
[process]
blade_speed = "100 mm/s"
[powder.A]
material = "SS17-4PH"
[powder.B]
material = "IN718"
[target]
shape = "linear"
from = { y = "0.4 mm", gi = 0.0 }
to = { y = "1.2 mm", gi = 1.0 }
footprint = { x = ["1.6 mm", "3.2 mm"] }
bin_width = "0.2 mm"
[design_space]
dosage_factor = 3.0
[numerics]
reductions = ["fines_cut", "shallow_bed", "strip_map"]
strip_width = "0.4 mm"
)";

StudyReader reader(const std::string& text = kStudy) {
    return [text](const std::vector<std::string>& overrides) {
        return parse_study(text, "study.toml", overrides);
    };
}

/// Large grains lay the powder from farther back by `shift` of the dispenser per unit of coarsening; cost as
/// the engine's: grains x steps.
SpreadFunction engine(double shift, std::shared_ptr<Calls> calls) {
    return [=](const Scene& scene, const PartitionCurve* partition, const SpreadOptions&) {
        const double coarse = scene.powder[0].size.d50 / 40e-6 - 1;
        Heap heap;
        heap.grains_per_m2 = 1200 / (3.2e-3 * 0.4e-3);
        heap.centre += shift * coarse;
        Scene other = scene;  // another level, another bed
        other.seed ^= std::hash<std::string>{}(scene.canonical_text());
        SpreadResult result = testing_heap::spread(heap, *calls, other, partition);
        const double fines = scene.powder[0].size.cut_low < 20e-6 ? 2 : 1;
        result.steps = long(1e5 * std::sqrt(scene.softening / 1e-4) * 0.2 / scene.rayleigh_fraction * fines /
                            (1 + coarse));
        result.seconds_cold = 1e-3 * double(result.steps) / std::pow(1 + coarse, 2);
        if (scene.softening < 9e-5) {
            result.health.status = "overlap";
            result.health.reason = "too soft";
        }
        return result;
    };
}

TradeoffOptions options_with(double shift, std::shared_ptr<Calls> calls, int seeds) {
    TradeoffOptions options;
    options.seeds = seeds;
    options.run.spread = engine(shift, std::move(calls));
    return options;
}

const TradeoffLevel& level(const Tradeoff& t, const std::string& name) {
    for (const TradeoffLevel& one : t.levels)
        if (one.name == name) return one;
    ADD_FAILURE() << "no level " << name;
    return t.levels.front();
}

std::vector<std::string> names(const Tradeoff& t) {
    std::vector<std::string> out;
    for (const TradeoffLevel& one : t.levels) out.push_back(one.name);
    return out;
}

TEST(Tradeoff, the_ladder_starts_with_everything_undone_and_takes_one_reduction_at_a_time) {
    const Tradeoff t = plan_tradeoff(reader(), {});
    ASSERT_EQ(names(t),
              (std::vector<std::string>{"finest", "study", "fines_cut", "shallow_bed", "softening 1e-04",
                                        "softening 3e-05", "time step 0.2 T_R", "time step 0.3 T_R",
                                        "early_stop", "blade speed x 1.5", "coarse x 1.25", "coarse x 1.5",
                                        "coarse x 2", "half the strip"}));
    const ReductionSettings& finest = t.levels[0].settings;
    EXPECT_EQ(finest.names, std::vector<std::string>{"strip_map"});
    EXPECT_DOUBLE_EQ(finest.softening, 3e-4);
    EXPECT_DOUBLE_EQ(finest.rayleigh_fraction, 0.1);
    for (std::size_t k = 2; k < t.levels.size(); ++k) {
        int departures = 0;
        const auto a = finest.overrides(), b = t.levels[k].settings.overrides();
        for (const std::string& one : b) departures += std::find(a.begin(), a.end(), one) == a.end();
        // the factor of coarse grains and a wider strip come with their name
        EXPECT_EQ(departures, t.levels[k].step == "coarse" ? 3 : 1) << t.levels[k].name;
        EXPECT_LT(t.levels[k].expected_grain_steps, 1.01 * t.levels[0].expected_grain_steps)
            << t.levels[k].name;
    }
}

TEST(Tradeoff, around_the_study_what_it_has_is_undone_and_what_it_lacks_is_taken) {
    TradeoffOptions options;
    options.around_study = true;
    const Tradeoff t = plan_tradeoff(reader(), options);
    EXPECT_THAT(names(t), Contains("without fines_cut"));
    EXPECT_THAT(names(t), Contains("without softening"));
    EXPECT_THAT(names(t), Contains("without sleep"));
    EXPECT_THAT(names(t), Contains("coarse x 1.5"));
    EXPECT_FALSE(level(t, "without sleep").settings.sleep);
    EXPECT_EQ(level(t, "without fines_cut").settings.names,
              (std::vector<std::string>{"shallow_bed", "strip_map"}));
    EXPECT_DOUBLE_EQ(level(t, "without time_step").settings.rayleigh_fraction, 0.1);
    EXPECT_DOUBLE_EQ(level(t, "without time_step").settings.softening, 1e-4);
}

TEST(Tradeoff, a_level_that_the_study_file_refuses_stays_in_the_table_with_the_reason) {
    std::string narrow = kStudy;
    narrow.replace(narrow.find("strip_width = \"0.4 mm\""), 22, "strip_width = \"0.3 mm\"");
    const Tradeoff t = plan_tradeoff(reader(narrow), {});
    EXPECT_EQ(level(t, "half the strip").status, "not possible");
    EXPECT_THAT(level(t, "half the strip").reason, HasSubstr("numerics.strip_width"));
}

TEST(Tradeoff, a_reduction_that_the_study_makes_void_is_not_spread) {
    std::string deep = kStudy + "bed_depth = \"200 um\"\n";
    const Tradeoff t = plan_tradeoff(reader(deep), {});
    EXPECT_EQ(level(t, "shallow_bed").status, "not possible");
    EXPECT_THAT(level(t, "shallow_bed").reason, HasSubstr("the same scene as 'finest'"));
    EXPECT_EQ(level(t, "fines_cut").status, "waiting");
}

TEST(Tradeoff, a_known_error_is_found_and_a_free_reduction_is_told_from_it) {
    auto calls = std::make_shared<Calls>();
    const TradeoffOptions options = options_with(0.12, calls, 6);
    Tradeoff t = plan_tradeoff(reader(), options);
    run_tradeoff(t, reader(), options);
    // the truth: the kernel's GI at both centres
    const Study study = reader()({});
    Heap heap, moved;
    moved.centre += 0.12;
    const auto fine = testing_heap::truth(heap, study, start_design(study), false),
               coarse = testing_heap::truth(moved, study, start_design(study), false);
    double squares = 0, weights = 0;
    for (std::size_t b = 0; b < t.weight.size(); ++b)
        if (t.weight[b] > 0) {
            squares += t.weight[b] * std::pow(coarse.gi[b] - fine.gi[b], 2);
            weights += t.weight[b];
        }
    const double error = std::sqrt(squares / weights);
    ASSERT_GT(error, 0.05);
    const TradeoffLevel& two = level(t, "coarse x 2");
    EXPECT_NEAR(two.gi_error, error, 2 * two.noise_floor);
    EXPECT_FALSE(two.within_noise);
    // by chance a few of the levels without error look worse than they are
    int free = 0;
    for (const char* name : {"study", "fines_cut", "shallow_bed", "softening 1e-04", "time step 0.2 T_R",
                             "time step 0.3 T_R", "early_stop", "blade speed x 1.5"})
        free += level(t, name).within_noise;
    EXPECT_GE(free, 6);
    EXPECT_EQ(level(t, "softening 3e-05").status, "overlap");
    EXPECT_EQ(level(t, "softening 3e-05").runs.size(), 1u)
        << "what fails on one bed is not tried on the next";
    // all that is free together, and only that; of two time steps the faster
    const TradeoffLevel& all = t.levels.back();
    EXPECT_THAT(all.name, testing::StartsWith("combination"));
    EXPECT_FALSE(all.settings.has("coarse_map") && all.settings.coarse_factor > 1.9);
    EXPECT_EQ(all.settings.has("fines_cut"), level(t, "fines_cut").within_noise);
    EXPECT_EQ(all.settings.has("early_stop"), level(t, "early_stop").within_noise);
    if (level(t, "time step 0.3 T_R").within_noise) {
        EXPECT_DOUBLE_EQ(all.settings.rayleigh_fraction, 0.3);
    }
    for (const TradeoffLevel& one : t.levels)
        if (one.within_noise && one.status == "ok") {
            EXPECT_LE(one.speed_up, level(t, t.recommended).speed_up) << one.name;
        }
    EXPECT_NEAR(level(t, "fines_cut").speed_up, 2, 0.05);
    EXPECT_NEAR(level(t, "time step 0.3 T_R").speed_up, 3, 0.1);
}

TEST(Tradeoff, the_floor_is_what_equal_levels_differ_by) {
    auto calls = std::make_shared<Calls>();
    double ratios = 0;
    int beyond = 0;
    constexpr int kTables = 60;
    for (int k = 0; k < kTables; ++k) {
        TradeoffOptions options = options_with(0, calls, 3);
        options.only = {"study"};
        const StudyReader read = [k](std::vector<std::string> more) {
            more.push_back("run.seed=" + std::to_string(100 + k));
            return parse_study(kStudy, "study.toml", more);
        };
        Tradeoff t = plan_tradeoff(read, options);
        run_tradeoff(t, read, options);
        const double ratio = level(t, "study").gi_rmse / level(t, "study").noise_floor;
        ratios += ratio * ratio / kTables;
        beyond += !level(t, "study").within_noise;
    }
    // rms 1 but for the floor's own scatter (four degrees of freedom, each of one or two numbers)
    EXPECT_NEAR(std::sqrt(ratios), 1, 0.35);
    EXPECT_LE(beyond, kTables / 6);
}

TEST(Tradeoff, every_spread_is_handed_on_before_the_next_and_a_stop_keeps_them) {
    auto calls = std::make_shared<Calls>();
    TradeoffOptions options = options_with(0, calls, 2);
    std::atomic<bool> stop = false;
    options.run.stop = &stop;
    std::vector<std::size_t> seen;
    options.after_run = [&](const Tradeoff& t) {
        std::size_t runs = 0;
        for (const TradeoffLevel& one : t.levels) runs += one.runs.size();
        seen.push_back(runs);
        if (runs == 3) stop = true;
    };
    Tradeoff t = plan_tradeoff(reader(), options);
    run_tradeoff(t, reader(), options);
    EXPECT_EQ(seen, (std::vector<std::size_t>{1, 2, 3}));
    EXPECT_EQ(t.status, "interrupted");
    EXPECT_EQ(calls->map_seeds.size(), 3u);
    EXPECT_GT(level(t, "study").grains, 0);
    EXPECT_EQ(level(t, "fines_cut").runs.size(), 0u);
}

TEST(Tradeoff, only_the_levels_asked_for_run_and_no_combination) {
    auto calls = std::make_shared<Calls>();
    TradeoffOptions options = options_with(0, calls, 2);
    options.only = {"coarse x 1.5"};
    Tradeoff t = plan_tradeoff(reader(), options);
    run_tradeoff(t, reader(), options);
    EXPECT_EQ(names(t), (std::vector<std::string>{"finest", "coarse x 1.5"}));
    EXPECT_EQ(calls->map_seeds.size(), 4u);
}

/// Two levels of two beds in two bins that count (and one that does not).
Tradeoff by_hand() {
    Tradeoff t;
    t.weight = {1, 1, 0};
    t.y_m = {1, 2, 3};
    t.seeds = 2;
    t.levels.resize(2);
    const auto bed = [](double a, double b, long grains, double seconds) {
        TradeoffRun run;
        run.health.status = "ok";
        run.gi = {a, b, 9};
        run.grains = grains;
        run.seconds = seconds;
        run.packing_fraction = 0.3;
        run.health.max_overlap_ratio = 0.02;
        run.health.deep_contact_share = 0;
        return run;
    };
    t.levels[0].name = "finest";
    t.levels[0].runs = {bed(0.50, 0.70, 1000, 10), bed(0.54, 0.70, 1000, 12)};
    t.levels[1].name = "study";
    t.levels[1].runs = {bed(0.60, 0.80, 250, 2), bed(0.60, 0.88, 250, 3)};
    t.levels[0].status = t.levels[1].status = "ok";
    return t;
}

TEST(Tradeoff, floor_and_difference_of_a_table_by_hand) {
    Tradeoff t = by_hand();
    compare_levels(t);
    // differences of the means 0.08 and 0.14
    EXPECT_NEAR(t.levels[1].gi_rmse, std::sqrt((0.08 * 0.08 + 0.14 * 0.14) / 2), 1e-12);
    // variance x grains: squares 8e-4 x 1000 of the finest, 32e-4 x 250 of the study, 4 degrees of freedom
    const double shared = (8e-4 * 1000 + 32e-4 * 250) / 4;
    EXPECT_NEAR(t.levels[1].noise_floor, std::sqrt(shared / 250 / 2 + shared / 1000 / 2), 1e-12);
    EXPECT_NEAR(t.noise_rms, std::sqrt(2 * shared / 250 / 2), 1e-12);
    EXPECT_NEAR(t.levels[1].gi_error,
                std::sqrt(std::pow(t.levels[1].gi_rmse, 2) - std::pow(t.levels[1].noise_floor, 2)), 1e-12);
    EXPECT_NEAR(t.levels[1].speed_up, 11 / 2.5, 1e-12);
    EXPECT_NEAR(t.levels[1].packing_error, 0, 1e-12);
    EXPECT_FALSE(t.levels[1].within_noise);
    EXPECT_EQ(t.recommended, "finest");
}

TEST(Tradeoff, grains_that_overlap_too_much_are_not_recommended_however_fast) {
    Tradeoff t = by_hand();
    for (TradeoffRun& run : t.levels[1].runs) run.gi = t.levels[0].runs[0].gi;
    compare_levels(t);
    EXPECT_EQ(t.recommended, "study");
    t.levels[1].runs[0].health.max_overlap_ratio = 0.12;
    t.levels[1].runs[0].health.deep_contact_share = 5e-3;
    t.levels[1].runs[1].health.deep_contact_share = 1e-3;
    compare_levels(t);
    EXPECT_NEAR(t.levels[1].deep_contact_share, 3e-3, 1e-15);
    EXPECT_TRUE(t.levels[1].within_noise);
    EXPECT_EQ(t.recommended, "finest");
    // as deep, but a single grain of one bed
    t.levels[1].runs[0].health.deep_contact_share = 5e-4;
    t.levels[1].runs[1].health.deep_contact_share = 0;
    compare_levels(t);
    EXPECT_EQ(t.recommended, "study");
    // one in a thousand is the limit, and it is kept
    for (TradeoffRun& run : t.levels[1].runs) run.health.deep_contact_share = 1e-3;
    compare_levels(t);
    EXPECT_EQ(t.recommended, "study");
    // a grain wedged at the finest level excuses nobody
    t.levels[0].runs[0].health.max_overlap_ratio = 0.2;
    for (TradeoffRun& run : t.levels[1].runs) run.health.deep_contact_share = 2e-3;
    compare_levels(t);
    EXPECT_EQ(t.recommended, "finest");
    // ... but a tenth more than the finest has is allowed
    for (TradeoffRun& run : t.levels[0].runs) run.health.deep_contact_share = 1.9e-3;
    compare_levels(t);
    EXPECT_EQ(t.recommended, "study");
    for (TradeoffRun& run : t.levels[0].runs) run.health.deep_contact_share = 1.7e-3;
    compare_levels(t);
    EXPECT_EQ(t.recommended, "finest");
    // unknown is not kept, however few the other bed has
    t.levels[1].runs[0].health.deep_contact_share = std::nan("");
    t.levels[1].runs[1].health.deep_contact_share = 0;
    compare_levels(t);
    EXPECT_EQ(t.recommended, "finest");
}

}  // namespace
}  // namespace gradwright
