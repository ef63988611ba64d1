// Minimum of a function in a box without derivatives: NLopt with its traps handled once (interfaces.md,
// Libraries).
//   - steps out of the box by round-off are clipped before the function sees them
//   - the best point is our own record, not what the library returns
//   - ROUNDOFF_LIMITED is a normal end
//   - an exception of the objective is carried across and thrown again, with its text
//   - variables with low = high are left out; BOBYQA needs two free ones, a single one is searched by SBPLX
#pragma once
#include <functional>
#include <string>
#include <vector>

namespace gradwright {

enum class SearchMethod { bobyqa, sbplx };

struct BoundedSearch {
    SearchMethod method = SearchMethod::bobyqa;
    std::vector<double> low, high, start;
    std::vector<double> step;    ///< first step per variable, > 0; cut to a quarter of the box
    double x_tolerance = 1e-5;   ///< absolute, in the variables' own unit
    double f_tolerance = 0;      ///< absolute; 0 = not used
    int budget = 200;            ///< evaluations
    std::function<bool()> stop;  ///< looked at before every evaluation
};

struct BoundedSearchResult {
    std::vector<double> best;
    double value = 0;
    int evaluations = 0;
    std::string termination = "not_run";  ///< converged | budget | interrupted
    std::string native;                   ///< NLopt's own code and the method used
};

/// Throws what `objective` throws, std::invalid_argument when no variable is free.
BoundedSearchResult minimise(const std::function<double(const std::vector<double>&)>& objective,
                             const BoundedSearch& search);

}  // namespace gradwright
