#include "optimise/tolerance_budget.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "dem/random.h"

namespace gradwright {
namespace {

constexpr int kDraws = 2000;

double rms_over(const std::vector<double>& values, const std::vector<double>& weight) {
    double sum = 0;
    int n = 0;
    for (std::size_t b = 0; b < values.size(); ++b)
        if (weight[b] > 0) {
            sum += values[b] * values[b];
            ++n;
        }
    return n > 0 ? std::sqrt(sum / n) : 0;
}

/// Dimensions of one curve; `which` picks it out of the design.
void add_curve(std::vector<BuildDimension>& out, const std::vector<PlanPoint>& points,
               std::vector<PlanPoint> PartitionCurve::*which, char letter, ToleranceClass tolerance_class) {
    const auto add = [&](std::string name, double nominal, std::size_t k, double PlanPoint::*axis) {
        out.push_back({std::move(name), nominal, general_tolerance(tolerance_class, nominal),
                       [which, k, axis](const Design& design, double by) {
                           Design moved = design;
                           (moved.partition.*which)[k].*axis += by;
                           return moved;
                       }});
    };
    for (std::size_t k = 0; k < points.size(); ++k) {
        const bool end = k == 0 || k + 1 == points.size();
        // an end stands on a wall: x is the wall's
        if (!end) add(fmt::format("{}{} x", letter, k + 1), points[k].x, k, &PlanPoint::x);
        add(fmt::format("{}{} y", letter, k + 1), points[k].y, k, &PlanPoint::y);
    }
}

}  // namespace

double general_tolerance(ToleranceClass tolerance_class, double nominal) {
    // ISO 2768-1, table 1: permissible deviations [mm] for f, m, c, v by upper end of the nominal's range
    // [mm]
    struct Row {
        double to, f, m, c, v;
    };
    static constexpr std::array<Row, 8> kRows = {{{3, 0.05, 0.1, 0.2, 0.5},
                                                  {6, 0.05, 0.1, 0.3, 0.5},
                                                  {30, 0.1, 0.2, 0.5, 1},
                                                  {120, 0.15, 0.3, 0.8, 1.5},
                                                  {400, 0.2, 0.5, 1.2, 2.5},
                                                  {1000, 0.3, 0.8, 2, 4},
                                                  {2000, 0.5, 1.2, 3, 6},
                                                  {4000, 0.5, 2, 4, 8}}};
    const double length = std::fabs(nominal) * 1e3;
    const Row* row = std::find_if(kRows.begin(), kRows.end() - 1,
                                  [&](const Row& r) { return length <= r.to * (1 + 1e-12); });
    switch (tolerance_class) {
        case ToleranceClass::f:
            return row->f * 1e-3;
        case ToleranceClass::m:
            return row->m * 1e-3;
        case ToleranceClass::c:
            return row->c * 1e-3;
        case ToleranceClass::v:
            return row->v * 1e-3;
    }
    return row->m * 1e-3;
}

const char* to_string(ToleranceClass tolerance_class) {
    return std::array{"f", "m", "c", "v"}[std::size_t(tolerance_class)];
}

std::vector<BuildDimension> build_dimensions(const Study& study, const Design& design,
                                             ToleranceClass tolerance_class) {
    std::vector<BuildDimension> out;
    add_curve(out, design.partition.points, &PartitionCurve::points, 'P', tolerance_class);
    if (!design.partition.second.empty())
        add_curve(out, design.partition.second, &PartitionCurve::second, 'Q', tolerance_class);
    // where the plate stands is set in slots of the dispenser's walls, over its length and width
    const auto place = [&](const char* name, double nominal, double PlanPoint::*axis) {
        out.push_back({name, nominal, general_tolerance(tolerance_class, nominal),
                       [axis](const Design& design, double by) {
                           Design moved = design;
                           for (auto* points : {&moved.partition.points, &moved.partition.second})
                               for (PlanPoint& p : *points) p.*axis += by;
                           return moved;
                       }});
    };
    place("plate x", study.scene.dispenser_length, &PlanPoint::x);
    place("plate y", study.dispenser_width, &PlanPoint::y);
    return out;
}

Design drawn_plate(const std::vector<BuildDimension>& dimensions, const Design& design, std::uint64_t seed) {
    Random random(seed);
    Design plate = design;
    for (const BuildDimension& d : dimensions)
        plate = d.moved(plate, d.tolerance * (2 * random.uniform() - 1));
    return plate;
}

ToleranceBudget tolerance_budget(const Study& study, const Design& design, const Profile& profile,
                                 ToleranceClass tolerance_class, double asked, double noise_floor) {
    ToleranceBudget out;
    out.tolerance_class = tolerance_class;
    out.weight = bin_weights(study);
    out.asked = asked;
    out.noise_floor = noise_floor;
    out.promised = std::max(asked, noise_floor);
    const std::size_t bins = out.weight.size();
    out.worst_case.assign(bins, 0);
    out.rss.assign(bins, 0);
    out.band.assign(bins, 0);
    const std::vector<BuildDimension> dimensions = build_dimensions(study, design, tolerance_class);
    for (const BuildDimension& d : dimensions) {
        DimensionBudget budget{d.name, d.nominal, d.tolerance, {}, 0, 0, 0};
        const std::vector<double> up = profile(d.moved(design, d.tolerance)),
                                  down = profile(d.moved(design, -d.tolerance));
        for (std::size_t b = 0; b < bins; ++b) {
            const double slope = (up[b] - down[b]) / (2 * d.tolerance);
            budget.slope.push_back(std::isfinite(slope) ? slope : 0);
            const double moves = budget.slope[b] * d.tolerance;
            out.worst_case[b] += std::fabs(moves);
            out.rss[b] += moves * moves;
        }
        budget.slope_rms = rms_over(budget.slope, out.weight);
        out.dimensions.push_back(std::move(budget));
    }
    for (double& r : out.rss) r = std::sqrt(r);
    out.worst_case_rms = rms_over(out.worst_case, out.weight);
    out.rss_rms = rms_over(out.rss, out.weight);
    const double n = double(std::max<std::size_t>(1, out.dimensions.size()));
    for (DimensionBudget& d : out.dimensions) {
        d.share = out.rss_rms > 0 ? std::pow(d.slope_rms * d.tolerance / out.rss_rms, 2) : 0;
        d.needed = d.slope_rms > 0 ? out.promised / (std::sqrt(n) * d.slope_rms)
                                   : std::numeric_limits<double>::infinity();
    }
    const std::vector<double> ideal = profile(design);
    std::vector<std::vector<double>> size(bins);
    for (int k = 0; k < kDraws; ++k) {
        const std::vector<double> gi =
            profile(drawn_plate(dimensions, design, study.seed + std::uint64_t(k)));
        for (std::size_t b = 0; b < bins; ++b) {
            const double error = std::fabs(gi[b] - ideal[b]);
            size[b].push_back(std::isfinite(error) ? error : 0);
        }
    }
    for (std::size_t b = 0; b < bins; ++b) {
        const auto at = size[b].begin() + std::lround(0.95 * (kDraws - 1));
        std::nth_element(size[b].begin(), at, size[b].end());
        out.band[b] = *at;
    }
    out.band_rms = rms_over(out.band, out.weight);
    return out;
}

BandCheck check_band(const Study& study, const Design& design, const Profile& profile,
                     const ToleranceBudget& budget, int plates, std::uint64_t seed) {
    const auto dimensions = build_dimensions(study, design, budget.tolerance_class);
    const std::vector<double> ideal = profile(design);
    BandCheck out;
    int inside = 0, all = 0;
    for (int k = 0; k < plates; ++k) {
        const std::vector<double> gi = profile(drawn_plate(dimensions, design, seed + std::uint64_t(k)));
        ++out.plates;
        for (std::size_t b = 0; b < gi.size(); ++b) {
            if (!(budget.weight[b] > 0) || !std::isfinite(gi[b] - ideal[b])) continue;
            const double error = std::fabs(gi[b] - ideal[b]);
            out.worst_error = std::max(out.worst_error, error);
            inside += error <= budget.band[b];
            ++all;
        }
    }
    out.inside = all > 0 ? double(inside) / all : 0;
    return out;
}

}  // namespace gradwright
