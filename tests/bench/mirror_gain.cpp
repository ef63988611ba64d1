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

int run(const Study& study, const std::vector<Layer>& strips) {
    constexpr int kDraws = 12;
    const Design start = start_design(study);
    const Objective& asked = study.objective;
    fmt::print("{} strips; {} draws each; rms of misfit and x drift on the strips that were not drawn\n",
               strips.size(), kDraws);
    for (const std::size_t count : {std::size_t{1}, std::size_t{2}, std::size_t{4}})
        for (const bool mirrored : {false, true}) {
            std::mt19937 random(5);
            double misfit2 = 0, drift2 = 0;
            int within = 0;
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
                misfit2 += misfit * misfit / kDraws;
                drift2 += drift * drift / kDraws;
                within += misfit <= 0.75 * asked.tolerance && drift <= 0.75 * asked.x_drift_tolerance;
            }
            fmt::print(
                "{} strips, {}: misfit {:.4f}, x drift {:.4f}; within three quarters of both tolerances {} "
                "of {}\n",
                count, mirrored ? "mirrored" : "as they lie", std::sqrt(misfit2), std::sqrt(drift2), within,
                kDraws);
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
