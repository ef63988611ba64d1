// Search over what moves grains (motion.h), each point carrying its own best partition: partition and
// footprint are labels on a map and free of charge, a new motion costs a map (inverse-design.md).
//
// Between motions that were spread the transport kernel is interpolated, linearly on the Delaunay simplex
// that holds the point: origins are pooled from the maps at its corners, each with its share, so that the GI
// of any partition is the same mean of theirs. Nothing is taken from such a map but where to spread next: the
// motion it calls best is spread (the check), and joins the corners. The search ends when the best of the
// interpolated maps is a motion already spread or promises nothing better, or with its budget; its answer is
// always a motion that was spread.
// A motion that the study's constraints forbid is moved to the nearest that keeps them before it is looked
// at.
//
// The first points are the start; the motion whose heap turns over most nearly kBestTurnovers times on its
// way to the part; then corners of the box, the furthest from all before first. Doses of the two chambers,
// where both are free, act through their mean, which moves grains, and through their ratio, which to first
// order only weighs the chambers (chamber_fill.h): the ratio is searched with the labels. A step between
// their levels of more than a grain flows sideways, which no strip shows: its doubt (step_doubt) counts
// against it.
#pragma once
#include <functional>
#include <string>
#include <vector>

#include "optimise/ceres_fit.h"
#include "optimise/strategy_support.h"

namespace gradwright {

/// Spreads that a search leaves for confirmations, where the budget has them.
inline constexpr int kReserve = 2;

/// Turnovers of the heap on its way to the middle of the part: (land + middle of the footprint) / sqrt(h
/// L_d), h the dose height: the way in heap lengths [-].
double turnovers_to_part(const Study& study, const Design& design);
/// Where a straight partition drifts least along x: the order of origins has turned round once and stands
/// between both. docs/motion-map.md: rms drift 0.08 from 7.5 to 9.6 turnovers, 0.14 and more on both sides,
/// over 45 motions of the coupon. Other dispensers and powders have their own: it is where a search looks
/// second.
inline constexpr double kBestTurnovers = 8.6;

/// Shares of `points` (each of the same dimension >= 1) that interpolate at `at`, sum 1: barycentric on the
/// smallest simplex of them around it, which is Delaunay's; outside their hull the nearest one alone.
std::vector<double> interpolation_shares(const std::vector<std::vector<double>>& points,
                                         const std::vector<double>& at);

class MotionSearch {
  public:
    /// `start`: the design to begin with. All must outlive the search.
    MotionSearch(StrategyRun& run, const Design& start);
    /// The best motion, its footprint and chamber doses placed; spreads maps within the run's budget. `start`
    /// where nothing is free.
    Design best();

  private:
    /// One direction of the search. Its value is set into a design.
    struct Direction {
        std::string name;
        double low = 0, high = 0, start = 0;
        std::function<void(Design&, double)> set;
    };
    struct Node {
        std::vector<double> at;  ///< of the directions that spread, each as a share of its range
        Design motion;
        double objective = 0;
    };
    void add_chambers(const char* name, std::array<double, 2> Design::*values,
                      const std::array<Variable, 2>& variables, bool mean_too);
    Design design_at(const std::vector<double>& spreads, const std::vector<double>& labels) const;
    /// Coordinates in the box of the directions that spread, corners and start.
    std::vector<std::vector<double>> first_points(std::size_t count) const;
    /// Spreads there; false when it gave no map, or nothing may be spread any more.
    bool spread(const std::vector<double>& at, double promised);
    OriginMap& map_at(const std::vector<double>& at, OriginMap& between);
    /// The motion with its own best partition on this map.
    Evaluation nested(const Design& motion, OriginMap& map);
    /// Least of `objective` over a box of `n` shares of ranges: a lattice or a low-discrepancy set, then a
    /// local search from its best.
    std::vector<double> least(std::size_t n,
                              const std::function<double(const std::vector<double>&)>& objective,
                              const std::vector<double>& start, double& value) const;
    std::string describe(const Design& motion) const;
    /// Shares of the directions' ranges moved to where the constraints that name no part of the partition are
    /// kept; those that do are the fit's. `labels_only`: what spreads stays.
    void keep(std::vector<double>& spreads, std::vector<double>& labels, bool labels_only) const;

    StrategyRun& run_;
    const Study& study_;
    const Design start_;
    std::vector<Direction> spreads_, labels_;
    std::vector<Node> nodes_;
    Study only_motion_;  ///< the study with those constraints alone
};

}  // namespace gradwright
