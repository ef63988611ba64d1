// The main job with the real engine on a scene small enough for a test: study text in, verdict out.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "optimise/design_run.h"
#include "optimise/study_file.h"

namespace gradwright {
namespace {

/// A quarter-size coupon: 0.9 x 0.8 mm dispenser. Physics of the shipped examples.
std::string tiny_study() {
    return R"(
[study]
name = "tiny"
[machine]
dispenser = { length = "0.9 mm", width = "0.8 mm", depth = "1 mm" }
platform  = { length = "0.9 mm" }
land = "0.8 mm"
second_land = "0.8 mm"
blade = { thickness = "0.2 mm" }
[process]
layer_thickness = "40 um"
blade_speed = "100 mm/s"
substrate = "fused"
gap = "steady"
steady_packing = 0.28
sides = "periodic"
[powder.A]
material = "SS17-4PH"
[powder.B]
material = "IN718"
[target]
shape = "linear"
from = { y = "0.2 mm", gi = 0.0 }
to   = { y = "0.6 mm", gi = 1.0 }
footprint = { x = ["0.2 mm", "0.9 mm"] }
bin_width = "0.1 mm"
[design_space]
partition = { family = "polyline", knots = 3, monotone = true }
dosage_factor = 3.0
[objective]
tolerance = 0.2
x_drift_tolerance = 0.5
[numerics]
time_step = { rayleigh_fraction = 0.2 }
bed_depth = "80 um"
reductions = ["fines_cut", "shallow_bed", "strip_map"]
strip_width = "0.3 mm"
[run]
seed = 3
max_spreads = 2
)";
}

StudyResult design(const Study& study, int threads, const std::string& journal = "") {
    RunOptions options;
    options.threads = threads;
    options.journal_folder = journal;
    return run_map_strategy(study, options);
}

TEST(EndToEnd, a_tiny_study_is_designed_and_confirmed) {
    const Study study = parse_study(tiny_study(), "tiny.toml");
    const std::filesystem::path journal =
        std::filesystem::temp_directory_path() / "gradwright end to end journal";
    std::filesystem::remove_all(journal);
    const StudyResult one = design(study, 2, journal.string());
    ASSERT_EQ(one.termination == "failed", false) << one.message;
    ASSERT_GE(one.confirmations.size(), 1u) << one.message;
    EXPECT_EQ(one.spreads_map, 1);
    EXPECT_EQ(one.spreads_full, 1);

    // The confirmation packed its own bed and carried both powders.
    EXPECT_NE(one.confirmations[0].seed, one.map_layers.at(0).packing_seed);
    EXPECT_FALSE(one.map_layers[0].labelled);
    EXPECT_GT(one.capture_fraction, 0.1);
    EXPECT_LT(one.capture_fraction, 1.0);
    EXPECT_GT(one.packing_fraction, 0.1);
    EXPECT_LT(one.packing_fraction, 0.6);

    // A ramp was asked for and a ramp was laid: rising from mostly B to mostly A over the counting bins.
    const auto& gi = one.confirmed.gi;
    std::vector<double> counting;
    for (std::size_t b = 0; b < gi.size(); ++b)
        if (one.weight[b] > 0) counting.push_back(gi[b]);
    ASSERT_GE(counting.size(), 3u);
    EXPECT_GT(counting.back() - counting.front(), 0.3);
    for (const double value : counting) EXPECT_TRUE(std::isfinite(value));
    EXPECT_LT(one.misfit.value, 0.25);

    // Each finished evaluation is one file.
    int files = 0;
    for (const auto& entry : std::filesystem::directory_iterator(journal))
        files += entry.path().extension() == ".json";
    EXPECT_GE(files, 3);
    std::filesystem::remove_all(journal);

    // Nothing in the answer depends on the number of threads.
    const StudyResult other = design(study, 1);
    ASSERT_EQ(other.confirmations.size(), one.confirmations.size());
    EXPECT_EQ(other.confirmations[0].state_hash, one.confirmations[0].state_hash);
    EXPECT_EQ(other.confirmed.gi, one.confirmed.gi);
    EXPECT_EQ(other.misfit.value, one.misfit.value);
    EXPECT_EQ(other.misfit.interval_high, one.misfit.interval_high);
    ASSERT_EQ(other.design.partition.points.size(), one.design.partition.points.size());
    for (std::size_t i = 0; i < other.design.partition.points.size(); ++i) {
        EXPECT_EQ(other.design.partition.points[i].x, one.design.partition.points[i].x);
        EXPECT_EQ(other.design.partition.points[i].y, one.design.partition.points[i].y);
    }
}

/// How far the step of GI stands from the other's, in bins, over the standard error of that: the sum of the
/// differences over the bins that count. A single number that all bins tell of: an rms has the noise of each.
double step_shift(const Evaluation& one, const Evaluation& other) {
    double sum = 0, variance = 0;
    for (std::size_t b = 0; b < one.weight.size(); ++b) {
        if (!(one.weight[b] > 0)) continue;
        sum += one.profile.gi[b] - other.profile.gi[b];
        variance += std::pow(one.profile.standard_error[b], 2) + std::pow(other.profile.standard_error[b], 2);
    }
    return sum / std::sqrt(variance);
}

/// GI summed over the bins that count: where the step stands, in bins. Of several beds with both powders.
struct Beds {
    double mean = 0, standard_error = 0;
};
Beds beds_of(const Study& study, const Design& design, int count, const RunOptions& options) {
    double sum = 0, square = 0;
    for (int bed = 0; bed < count; ++bed) {
        const Evaluation e =
            evaluate_once(study, design, Fidelity::full, confirmation_seed(study.seed, bed), options);
        if (!e.health.ok()) {
            ADD_FAILURE() << "bed " << bed << ": " << e.health.reason;
            continue;
        }
        double place = 0;
        for (std::size_t b = 0; b < e.weight.size(); ++b)
            if (e.weight[b] > 0) place += e.profile.gi[b];
        sum += place;
        square += place * place;
    }
    const double mean = sum / count;
    // four beds may all lay the same step, but for a rounding
    return {mean, std::sqrt(std::max(0.0, square - count * mean * mean) / (count - 1) / count)};
}

TEST(EndToEnd, a_light_powder_shows_in_the_confirmation_and_not_in_the_map) {
    // Free-flowing grains, A and B side by side along the blade's way. Where B has a third of A's density
    // (steel beside AlSi10Mg), A pushes sideways into it: the step of GI moves by a third of a bin. No map
    // without labels can know that. Beds differ by as much, so it takes some to see it, and they say how sure
    // that is.
    std::string text = tiny_study();
    const auto replace = [&text](const std::string& what, const std::string& by) {
        const std::size_t at = text.find(what);
        ASSERT_NE(at, std::string::npos) << what;
        text.replace(at, what.size(), by);
    };
    replace("land = \"0.8 mm\"", "land = \"1.2 mm\"");
    replace("{ family = \"polyline\", knots = 3, monotone = true }",
            "{ family = \"straight\", angle = \"0 deg\", offset = \"0 mm\" }");
    replace("shape = \"linear\"", "shape = \"step\"");
    replace("from = { y = \"0.2 mm\", gi = 0.0 }", "y = \"0.4 mm\"");
    replace("to   = { y = \"0.6 mm\", gi = 1.0 }", "");
    text += "[interaction]\nstatic_friction = 0.1\nrolling_friction = 0.0\nwork_of_adhesion = \"0 J/m2\"\n";
    const Study like = parse_study(text, "like.toml");
    replace("material = \"IN718\"",
            "material = { density = \"2670 kg/m3\", youngs_modulus = \"195 GPa\", poissons_ratio = 0.3 }");
    const Study unlike = parse_study(text, "light.toml");

    RunOptions options;
    options.threads = 2;
    const Design along = start_design(like);
    const Evaluation predicted = evaluate_once(like, along, Fidelity::map, map_seed(like.seed, 0), options);
    ASSERT_TRUE(predicted.health.ok()) << predicted.health.reason;
    const std::uint64_t unseen = confirmation_seed(like.seed, 0);
    const Evaluation heavy = evaluate_once(like, along, Fidelity::full, unseen, options);
    ASSERT_TRUE(heavy.health.ok()) << heavy.health.reason;
    EXPECT_LT(std::abs(step_shift(heavy, predicted)), 2);
    EXPECT_TRUE(heavy.every_grain);
    const Beds steel = beds_of(like, along, 4, options), light = beds_of(unlike, along, 8, options);
    EXPECT_GT(light.mean - steel.mean, 2 * std::hypot(light.standard_error, steel.standard_error))
        << light.mean << " +- " << light.standard_error << " against " << steel.mean << " +- "
        << steel.standard_error;
}

}  // namespace
}  // namespace gradwright
