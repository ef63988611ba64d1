// Minimum of a function in a box without derivatives: NLopt with its traps handled once (interfaces.md,
// Libraries).
//   - steps out of the box by round-off are clipped before the function sees them
//   - the best point is our own record, not what the library returns (COBYLA returns its last)
//   - the budget is ours too: no method calls the function once more than it may
//   - ROUNDOFF_LIMITED is a normal end
//   - an exception of the objective is carried across and thrown again, with its text
//   - variables with low = high are left out; BOBYQA needs two free ones, a single one is searched by SBPLX
//   - every method sees the start: DIRECT begins at the box's middle, so it is given the start beforehand
//   - populations are cut to the budget: CRS's own 10 (n + 1) and ISRES's 20 (n + 1) would spend a budget of
//     spreads on their first, random generation
//
// Which method for what (n free variables):
//   bobyqa  quadratic model in a trust region: smooth functions, from 2 n + 1 evaluations on
//   cobyla  linear model in a trust region: n + 1 evaluations to begin, slow in curved valleys, stalls on
//   kinks sbplx   Nelder-Mead in subspaces: kinks and steps, more evaluations crs     controlled random
//   search with local mutation: several valleys, some ten (n + 1) evaluations isres   evolution strategy:
//   several valleys, noisy functions; the most evaluations of all direct  DIRECT-L, dividing rectangles:
//   several valleys, nothing random; few variables
// Global methods rarely call themselves finished: that their budget ends them is the rule.
#pragma once
#include <array>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gradwright {

enum class SearchMethod { bobyqa, cobyla, sbplx, crs, isres, direct };
inline constexpr std::array kSearchMethods = {SearchMethod::bobyqa, SearchMethod::cobyla,
                                              SearchMethod::sbplx,  SearchMethod::crs,
                                              SearchMethod::isres,  SearchMethod::direct};
const char* to_string(SearchMethod method);
std::optional<SearchMethod> search_method(const std::string& name);

struct BoundedSearch {
    SearchMethod method = SearchMethod::bobyqa;
    std::vector<double> low, high, start;
    std::vector<double> step;    ///< first step per variable, > 0; cut to a quarter of the box
    double x_tolerance = 1e-5;   ///< absolute, in the variables' own unit
    double f_tolerance = 0;      ///< absolute; 0 = not used
    int budget = 200;            ///< evaluations, >= 1
    std::uint64_t seed = 1;      ///< of crs and isres; the others draw nothing
    std::function<bool()> stop;  ///< looked at before every evaluation
};

struct BoundedSearchResult {
    std::vector<double> best;
    double value = 0;
    int evaluations = 0;
    std::string termination = "not_run";  ///< converged | budget | interrupted | failed (NLopt gave up)
    std::string native;                   ///< NLopt's own code and the method used
};

/// Throws what `objective` throws, std::invalid_argument when no variable is free. A value that is no number
/// is never the best, and the method sees something worse than all before.
BoundedSearchResult minimise(const std::function<double(const std::vector<double>&)>& objective,
                             const BoundedSearch& search);

}  // namespace gradwright
