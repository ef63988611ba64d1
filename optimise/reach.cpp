#include "optimise/reach.h"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <functional>
#include <limits>
#include <tuple>

#include "optimise/ceres_fit.h"
#include "optimise/journal.h"
#include "optimise/map_evaluator.h"
#include "optimise/motion.h"
#include "optimise/spread_runner.h"

namespace gradwright {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kFlat = 0.01;  // GI: a target that varies by less asks for no gradation
constexpr int kQuoted = 3;      // candidates whose noise is looked at, the best by their raw numbers
constexpr int kScanStarts = 2;  // around each closed form, a third of the effort that the own target gets
constexpr double kComfortable = 0.7;  // of a tolerance: as the map strategy, no second opinion below it

/// Larger of misfit and drift in their tolerances: raw, and by the upper 95 % bounds.
double raw_distance(const Evaluation& e) {
    return std::max(e.misfit.value / e.misfit.tolerance, e.drift_misfit.value / e.drift_misfit.tolerance);
}
double bound_distance(const Evaluation& e) {
    const double distance = std::max(e.misfit.interval_high / e.misfit.tolerance,
                                     e.drift_misfit.interval_high / e.drift_misfit.tolerance);
    return std::isnan(distance) ? std::numeric_limits<double>::infinity() : distance;
}

bool within(const Misfit& misfit) {
    return misfit.debiased <= misfit.tolerance;
}

class Reacher {
  public:
    Reacher(const Study& study, const ReachOptions& options)
        : study_(study),
          options_(options),
          runner_(options.run),
          journal_(options.run.journal_folder),
          map_(study_, runner_, &journal_),
          motion_(start_design(study)) {
        reach_.ramp.variable = "full width of a linear ramp";
        reach_.shift.variable = "centre of a linear ramp";
        reach_.sigmoid.variable = "10-90 % width of a logistic sigmoid";
        for (ReachScan* scan : {&reach_.ramp, &reach_.shift, &reach_.sigmoid}) {
            scan->low = scan->high = kNan;
            scan->resolution = options.resolution > 0 ? options.resolution : 0.25 * study.bins.width;
        }
        set_window();
    }

    Reach run() {
        const auto begun = std::chrono::steady_clock::now();
        search();
        reach_.map_spreads = runner_.map_spreads;
        reach_.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
        reach_.seconds_cold = reach_.seconds + runner_.seconds_saved;
        return std::move(reach_);
    }

  private:
    void set_window() {
        Study plain = study_;
        plain.target.zones.clear();  // they belong to the study's own target
        const std::vector<double> weight = bin_weights(plain);
        for (int b = 0; b < int(weight.size()); ++b) {
            if (!(weight[b] > 0)) continue;
            if (reach_.bins++ == 0) reach_.window_low = study_.bins.low(b);
            reach_.window_high = study_.bins.low(b) + study_.bins.width;
        }
        const auto [low, high] = study_.target.gi_range();
        if (high - low > kFlat) {
            reach_.gi_low = low;
            reach_.gi_high = high;
        }
        reach_.rises = target_rises(study_);
    }

    void search() {
        const OriginMap& map = map_.map_of(motion_);
        if (!map.health.ok()) {
            reach_.status = map.health.status;
            reach_.reason = map.health.reason;
            return;
        }
        if (!FitProblem(study_, motion_, map.layers).usable()) {
            reach_.status = "no_bins";
            reach_.reason = reach_.bins > 0 ? "no laid grain in the footprint, or no bin of weight above 0"
                                            : "no bin lies in the footprint outside the side margins";
            return;
        }
        reach_.capture_fraction = map.capture_fraction;
        reach_.coverage = map_.quick(motion_).coverage;
        remark(map);

        const double window = reach_.window_high - reach_.window_low, bin = study_.bins.width;
        const double middle = 0.5 * (reach_.window_low + reach_.window_high);
        ReachPoint own = best(study_.target, 0, true);
        if (stopped()) return;  // a fit that was cut short says nothing
        reach_.own = std::move(own);
        scan(reach_.ramp, bin, window, ReachLimit::bin_width, [&](double w) { return ramp(middle, w); });
        if (stopped()) return;
        const double low = reach_.ramp.low, high = reach_.ramp.high;
        if (!std::isnan(low)) {
            const double own = std::abs(study_.target.y1 - study_.target.y0);
            const bool takes_own = study_.target.shape == TargetShape::linear && own >= low && own <= high;
            const double width = takes_own ? own : 0.5 * (low + high);
            reach_.shift.ramp_width = width;
            scan(reach_.shift, reach_.window_low + 0.5 * width, reach_.window_high - 0.5 * width,
                 ReachLimit::margins, [&](double centre) { return ramp(centre, width); });
            if (stopped()) return;
        }
        scan(reach_.sigmoid, bin, window, ReachLimit::bin_width, [&](double w) {
            return sigmoid_target(middle, w, reach_.rises ? reach_.gi_low : reach_.gi_high,
                                  reach_.rises ? reach_.gi_high : reach_.gi_low);
        });
        stopped();
    }

    void remark(const OriginMap& map) {
        for (const std::string& warning : map.health.warnings) reach_.remarks.push_back(warning);
        if (reach_.coverage < study_.objective.min_coverage)
            reach_.remarks.push_back(fmt::format(
                "coverage {:.3f} is below objective.min_coverage {:.3f} for every partition: raise "
                "the dosage factor",
                reach_.coverage, study_.objective.min_coverage));
        const DesignSpace& space = study_.design_space;
        if (const std::string names = free_motion(space); !names.empty())
            reach_.remarks.push_back(names +
                                     " stay at their start: `design` searches them, and may reach more");
        if (!moves_alike(study_))
            reach_.remarks.push_back(
                "the powders differ in size or density: a map without labels is only a first guess");
    }

    Target ramp(double centre, double width) const {
        return linear_target(centre - 0.5 * width, reach_.rises ? reach_.gi_low : reach_.gi_high,
                             centre + 0.5 * width, reach_.rises ? reach_.gi_high : reach_.gi_low);
    }

    bool stopped() {
        if (runner_.stopped()) reach_.status = "interrupted";
        return runner_.stopped();
    }

    /// Best partition for a target: least squares as the map strategy does it (drift weight varied where a
    /// tolerance is near), the choice by the upper 95 % bounds.
    ReachPoint best(const Target& target, double value, bool own = false) {
        if (options_.run.progress) options_.run.progress("reach", done_ / expected());
        ++done_;
        Study asked = study_;
        asked.target = target;
        FitOptions fit;
        fit.seed = study_.seed;
        fit.finalists = 6;
        if (!own) fit.perturbed_starts = kScanStarts;
        fit.stop = [this] { return runner_.stopped(); };
        FitProblem problem(asked, motion_, map_.map_of(motion_).layers);
        const FitResult first = fit_partition(asked, asked.design_space, motion_, problem, fit);
        std::vector<Design> found = first.finalists;
        const Objective& objective = study_.objective;
        if (objective.x_drift_weight > 0 &&
            std::max(first.misfit / objective.tolerance, first.drift / objective.x_drift_tolerance) >=
                kComfortable) {
            fit.perturbed_starts = 2;
            for (const double factor : {0.25, 4.0}) {
                problem.x_drift_weight = factor * objective.x_drift_weight;
                const FitResult other = fit_partition(asked, asked.design_space, motion_, problem, fit);
                found.insert(found.end(), other.finalists.begin(), other.finalists.end());
            }
        }
        std::vector<std::pair<double, std::size_t>> ranked;
        for (std::size_t i = 0; i < found.size(); ++i) {
            Evaluation quick = map_.quick(found[i]);
            judge(asked, quick);
            ranked.emplace_back(raw_distance(quick), i);
        }
        std::sort(ranked.begin(), ranked.end());
        ranked.resize(std::min<std::size_t>(ranked.size(), kQuoted));

        ReachPoint point;
        point.value = value;
        point.target = target;
        point.design = motion_;
        double least = std::numeric_limits<double>::infinity();
        for (const auto& [raw, i] : ranked) {
            Evaluation quoted = map_.quoted(found[i]);
            judge(asked, quoted);
            if (bound_distance(quoted) >= least && point.misfit.tolerance > 0) continue;
            least = bound_distance(quoted);
            point.design = found[i];
            point.misfit = quoted.misfit;
            point.drift = quoted.drift_misfit;
        }
        // no candidate has no numbers
        point.reachable = point.misfit.tolerance > 0 &&
                          combine(verdict_of(point.misfit), verdict_of(point.drift)) == Verdict::met;
        if (point.reachable) {
            point.limit = ReachLimit::none;
        } else if (within(point.misfit) && within(point.drift)) {
            point.limit = ReachLimit::noise;
        } else {
            // Fits trade profile against drift, so that at a limit both are too large. It is the drift that
            // binds when a partition that may drift as it likes lays the profile.
            problem.x_drift_weight = 0;
            const FitResult adrift = fit_partition(asked, asked.design_space, motion_, problem, fit);
            point.limit =
                adrift.ok && adrift.misfit <= objective.tolerance ? ReachLimit::x_drift : ReachLimit::profile;
        }
        return point;
    }

    /// Points that a scan takes at most.
    int bisections(double low, double high) const {
        const double spacing = (high - low) / (options_.grid - 1);
        return std::max(0, int(std::ceil(std::log2(spacing / reach_.ramp.resolution))));
    }
    double expected() const {
        const int each =
            options_.grid + 2 * bisections(study_.bins.width, reach_.window_high - reach_.window_low);
        return std::max(done_ + 1, 1 + 3 * each);
    }

    void scan(ReachScan& scan, double low, double high, ReachLimit below,
              const std::function<Target(double)>& target_at) {
        const bool one = high - low < scan.resolution;
        const int n = one ? 1 : options_.grid;
        for (int i = 0; i < n; ++i) {
            const double value = one ? 0.5 * (low + high) : low + i * (high - low) / (n - 1);
            ReachPoint point = best(target_at(value), value);
            if (runner_.stopped()) return;
            scan.points.push_back(std::move(point));
        }
        // the longest reachable stretch of the grid
        int first = -1, last = -2;
        for (int i = 0, begin = 0; i < n; ++i) {
            if (!scan.points[i].reachable)
                begin = i + 1;
            else if (i - begin > last - first)
                std::tie(first, last) = std::pair(begin, i);
        }
        if (first < 0) {
            const auto nearest = std::min_element(
                scan.points.begin(), scan.points.end(),
                [](const ReachPoint& a, const ReachPoint& b) { return distance(a) < distance(b); });
            scan.low_limit = scan.high_limit = nearest->limit;
            return;
        }
        const int reachable = int(std::count_if(scan.points.begin(), scan.points.end(),
                                                [](const ReachPoint& p) { return p.reachable; }));
        scan.gaps = reachable > last - first + 1;
        const std::vector<ReachPoint> grid = scan.points;
        scan.low = first == 0 ? grid[0].value
                              : bisect(scan, grid[first], grid[first - 1], scan.low_limit, target_at);
        if (first == 0) scan.low_limit = below;
        scan.high = last == n - 1 ? grid[last].value
                                  : bisect(scan, grid[last], grid[last + 1], scan.high_limit, target_at);
        if (last == n - 1) scan.high_limit = ReachLimit::margins;
        std::sort(scan.points.begin(), scan.points.end(),
                  [](const ReachPoint& a, const ReachPoint& b) { return a.value < b.value; });
    }

    static double distance(const ReachPoint& point) {
        return std::max(point.misfit.interval_high / point.misfit.tolerance,
                        point.drift.interval_high / point.drift.tolerance);
    }

    /// The reachable end of the bracket when it is no wider than the resolution; `limit`: of its other end.
    double bisect(ReachScan& scan, const ReachPoint& reachable, const ReachPoint& beyond, ReachLimit& limit,
                  const std::function<Target(double)>& target_at) {
        double good = reachable.value, bad = beyond.value;
        limit = beyond.limit;
        // 1 + 1e-9: grid spacings are quotients of decimal lengths
        while (std::abs(bad - good) > scan.resolution * (1 + 1e-9)) {
            const double middle = 0.5 * (good + bad);
            ReachPoint point = best(target_at(middle), middle);
            if (runner_.stopped()) break;
            point.on_grid = false;
            // Close to any limit the bounds say "noise"; what lies farther out says what it really is.
            if (!point.reachable && point.limit != ReachLimit::noise) limit = point.limit;
            (point.reachable ? good : bad) = middle;
            scan.points.push_back(std::move(point));
        }
        return good;
    }

    const Study study_;
    const ReachOptions options_;
    SpreadRunner runner_;
    Journal journal_;
    MapEvaluator map_;
    const Design motion_;
    Reach reach_;
    int done_ = 0;  ///< targets asked so far
};

}  // namespace

const char* to_string(ReachLimit limit) {
    switch (limit) {
        case ReachLimit::none:
            return "none";
        case ReachLimit::profile:
            return "profile";
        case ReachLimit::x_drift:
            return "x_drift";
        case ReachLimit::noise:
            return "noise";
        case ReachLimit::bin_width:
            return "bin_width";
        case ReachLimit::margins:
            return "margins";
    }
    return "none";
}

const char* meaning(ReachLimit limit) {
    switch (limit) {
        case ReachLimit::none:
            return "nothing binds";
        case ReachLimit::profile:
            return "the profile: transport and partition family lay it no closer; add knots, take another "
                   "family, "
                   "or change land or dosage_factor";
        case ReachLimit::x_drift:
            return "the x drift: the profile wanders along the part; change land, dosage_factor or the "
                   "footprint, "
                   "or let the partition fold (monotone = false)";
        case ReachLimit::noise:
            return "the noise of the map: raise run.map_spreads or widen the tolerance";
        case ReachLimit::bin_width:
            return "the bins: finer than one bin is not judged; make target.bin_width smaller";
        case ReachLimit::margins:
            return "the width: beyond the bins that count nothing is judged; widen footprint.y or the "
                   "dispenser";
    }
    return "";
}

Reach run_reach(const Study& study, const ReachOptions& options) {
    return Reacher(study, options).run();
}

}  // namespace gradwright
