// Every strategy of `design` behind one call: study -> StudyResult.
//
//   map      one spread without labels, the partition on its map, confirmed and corrected (map_strategy.cpp)
//   mf       the map corrected by full spreads on one bed, within a trust region (multi_fidelity_search.h)
//   bobyqa, cobyla, sbplx, crs, isres, direct
//            NLopt over any evaluator (bounded_search.h says which is for what)
//   ceres    Levenberg-Marquardt over any evaluator, own central differences (least_squares_strategy.h)
//
// Every one of them confirms its best on beds that its search never saw; the verdict comes from there alone.
#pragma once
#include <string>
#include <vector>

#include "optimise/design_run.h"

namespace gradwright {

struct StrategyChoice {
    std::string name = "map";
    /// What the NLopt ones and ceres evaluate: kinematic, map or full. map and mf have no choice.
    Fidelity fidelity = Fidelity::map;
    /// Evaluations of those. map and mf keep to study.max_spreads. About five times the variables of a
    /// five-knot polyline.
    int budget = 60;
};

/// In the order of the list above.
const std::vector<std::string>& strategy_names();
/// Does it evaluate one fidelity of the user's choice, within a budget of evaluations? map and mf do not.
bool searches_one_fidelity(const std::string& strategy);

/// Throws std::invalid_argument for a name that is not in the list and for fidelity lammps.
StudyResult run_strategy(const Study& study, const StrategyChoice& choice, const RunOptions& options);

}  // namespace gradwright
