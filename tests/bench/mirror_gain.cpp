// What reading a map in the mirror gains: partitions fitted to a few strips of a study, held against all the
// others. Usage: mirror_gain STUDY.toml OUT, OUT being the folder of a design of that study with many strips:
//   gradwright design STUDY.toml --set run.map_spreads=16 --set run.max_spreads=16 --out OUT
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numeric>
#include <random>
#include <sstream>

#include "dem/cache_file.h"
#include "dem/spread_file.h"
#include "optimise/ceres_fit.h"
#include "optimise/evaluation.h"
#include "optimise/strategy_support.h"
#include "optimise/study_file.h"

namespace gradwright {
namespace {

std::vector<Layer> strips_of(const std::string& folder) {
    std::vector<std::filesystem::path> files;
    for (const auto& file : std::filesystem::directory_iterator(folder)) files.push_back(file.path());
    std::sort(files.begin(), files.end());
    std::vector<Layer> strips;
    for (const auto& file : files) {
        std::ifstream in(file, std::ios::binary);
        std::stringstream stream;
        stream << in.rdbuf();
        const std::string all = stream.str();
        constexpr std::size_t kHash = 16;
        std::size_t at = 0;
        std::vector<char> key;
        SpreadResult spread;
        if (all.size() > kHash && take(all, at, key) &&
            read_spread(all.substr(at, all.size() - kHash - at), spread) && !spread.layer.labelled)
            strips.push_back(std::move(spread.layer));
    }
    return strips;
}

FitProblem problem_of(const Study& study, const Design& start, const std::vector<Layer>& strips,
                      bool mirrored) {
    FitProblem problem(study, start, strips);
    for (PooledGrains* grains : {&problem.grains, &problem.thirds.first, &problem.thirds.last})
        grains->mirrored = mirrored;
    for (PooledGrains& column : problem.columns) column.mirrored = mirrored;
    return problem;
}

/// Variance between single strips over the variance that the blocks of one tell, summed over the bins that
/// count: what beds_over_blocks is taken from.
struct Ratio {
    double between = 0, told = 0;
    void add(const std::vector<std::vector<double>>& values, const std::vector<std::vector<double>>& errors,
             const std::vector<double>& weight) {
        const auto n = static_cast<double>(values.size());
        for (std::size_t b = 0; b < weight.size(); ++b) {
            if (!(weight[b] > 0)) continue;
            double mean = 0;
            for (const auto& value : values) mean += value[b] / n;
            for (std::size_t k = 0; k < values.size(); ++k) {
                between += (values[k][b] - mean) * (values[k][b] - mean) / (n - 1);
                told += errors[k][b] * errors[k][b] / n;
            }
        }
    }
};
void add_ratios(const Study& study, const std::vector<Layer>& strips, const Design& design, bool mirrored,
                Ratio& profile, Ratio& drift) {
    HomogeneousOptions options;
    options.resamples = 1;  // any: the variance is in closed form
    std::vector<std::vector<double>> gi, gi_error, difference, difference_error;
    for (const Layer& strip : strips) {
        PooledGrains grains = pool_grains({&strip, 1}, study.footprint.x_low, study.footprint.x_high);
        grains.mirrored = mirrored;
        const GradationProfile p = homogeneous_profile(grains, design.partition, study.bins, options);
        const XDrift d = homogeneous_drift(grains, design.partition, study.bins, options);
        gi.push_back(p.gi);
        gi_error.push_back(p.standard_error);
        difference.push_back(d.difference);
        difference_error.push_back(d.standard_error);
    }
    profile.add(gi, gi_error, bin_weights(study));
    drift.add(difference, difference_error, drift_weights(study));
}

int run(const Study& study, const std::vector<Layer>& strips) {
    constexpr int kDraws = 12;
    const Design start = start_design(study);
    const Objective& asked = study.objective;
    double judged = 0;  // bins that count
    for (const double w : bin_weights(study)) judged += w > 0;
    fmt::print(
        "{} strips, {} draws a row\n\n| fitted to | misfit on the others, rms | x drift | within 3/4 of both "
        "tolerances | sd between strips, GI | its variance over the blocks' | the same of x drift |\n"
        "|---|---|---|---|---|---|---|\n",
        strips.size(), kDraws);
    for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{4}})
        for (const bool mirrored : {false, true}) {
            std::mt19937 random(5);
            double misfit2 = 0, drift2 = 0;
            int within = 0;
            Ratio profile_ratio, drift_ratio;
            for (int draw = 0; draw < kDraws; ++draw) {
                std::vector<std::size_t> order(strips.size());
                std::iota(order.begin(), order.end(), 0);
                std::shuffle(order.begin(), order.end(), random);
                std::vector<Layer> drawn, others;
                for (std::size_t k = 0; k < order.size(); ++k)
                    (k < count ? drawn : others).push_back(strips[order[k]]);
                FitOptions options;
                options.finalists = 6;
                const FitResult fit = fit_partition(study, study.design_space, start,
                                                    problem_of(study, start, drawn, mirrored), options);
                if (!fit.ok) continue;
                const PartitionFamily family(study.design_space, study.scene.dispenser_length,
                                             study.dispenser_width, fit.orientation);
                const auto [misfit, drift] =
                    problem_of(study, start, others, true).hard_misfit_and_drift(family, fit.p);
                add_ratios(study, strips, fit.design, mirrored, profile_ratio, drift_ratio);
                misfit2 += misfit * misfit / kDraws;
                drift2 += drift * drift / kDraws;
                within += misfit <= 0.75 * asked.tolerance && drift <= 0.75 * asked.x_drift_tolerance;
            }
            fmt::print("| {}, {} | {:.3f} | {:.3f} | {} of {} | {:.3f} | {:.1f} | {:.1f} |\n", count,
                       mirrored ? "mirrored" : "as they lie", std::sqrt(misfit2), std::sqrt(drift2), within,
                       kDraws, std::sqrt(profile_ratio.between / kDraws / judged),
                       profile_ratio.between / profile_ratio.told, drift_ratio.between / drift_ratio.told);
        }
    return 0;
}

}  // namespace
}  // namespace gradwright

int main(int argc, char** argv) {
    if (argc != 3) {
        fmt::print(stderr, "usage: mirror_gain STUDY.toml OUT\n");
        return 2;
    }
    const auto strips = gradwright::strips_of(std::string(argv[2]) + "/spreads");
    if (strips.size() < 8) {
        fmt::print(stderr, "mirror_gain: {} strips without labels in {}/spreads; at least 8 are needed\n",
                   strips.size(), argv[2]);
        return 3;
    }
    return gradwright::run(gradwright::read_study(argv[1]), strips);
}
