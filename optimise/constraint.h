// Linear constraints that a study states over its named variables, low <= sum factor x variable <= high, and
// the point next to one that keeps them.
//
// Every search moves in a box; what it proposes is moved to the nearest point of the box that keeps all
// constraints before it is evaluated, so that no design is ever looked at that breaks one, and an optimum on
// the border is met on the border. Rejected: a price alone (an optimum on the border is then missed by what
// the price's slope allows, or the price's kink stops a quadratic model), and NLopt's own inequality
// constraints (of the methods offered only COBYLA and ISRES have them).
//
// The nearest point is that of Dykstra (1983): cyclic projections on half spaces and box, each with its own
// memory, converge to the projection on their intersection. A monotone polyline's heights are products of its
// parameters; there the half spaces are those of the linear model at the last point, a few times over.
#pragma once
#include <array>
#include <cstddef>
#include <functional>
#include <limits>
#include <span>
#include <string>
#include <utility>
#include <vector>

namespace gradwright {

struct Study;
struct Design;
struct Evaluation;
class PartitionFamily;

/// One [[constraint]] of a study.
struct LinearConstraint {
    std::string name;
    std::vector<std::pair<std::string, double>> terms;  ///< variable ("partition.y1", "land"), factor [-]
    double low = -std::numeric_limits<double>::infinity(), high = std::numeric_limits<double>::infinity();
    std::string dimension;  ///< of every term: "length", "angle" or "" [SI: m, rad, -]
};

/// How a design, or what was measured of it, stands to one constraint or limit.
struct ConstraintState {
    std::string name;
    std::string dimension;
    double value = 0, low = 0, high = 0;  ///< SI; an open end is infinite
    /// Distance to the nearer bound, < 0 where it is broken. SI
    double slack = 0;
    double scale = 1;    ///< SI per unit of what a search moves in
    bool limit = false;  ///< a limit of [objective] on a measured number, not a linear constraint

    /// To 1e-9 of the scale: the rounding of sums.
    bool kept() const { return slack >= -1e-9 * scale; }
};

/// Of a partition's own numbers and of the motion: what a term may name, with its dimension.
std::vector<std::pair<std::string, std::string>> constraint_variables(const Study& study);

/// A study's constraints on this design, in the order of the study. One over variables that the design's
/// family has not is left out.
std::vector<ConstraintState> constraint_states(const Study& study, const Design& design);
/// The limits of [objective] on what was measured.
std::vector<ConstraintState> limit_states(const Study& study, double waste_fraction, double supply_ratio);
/// Sum of how far they are broken, in scales; 0 when all are kept.
double broken(const std::vector<ConstraintState>& states);
/// The one that is broken furthest, or, where none is, the one with the least slack; null for an empty list.
const ConstraintState* binding(const std::vector<ConstraintState>& states);
/// "'knots fall' is short by 0.02 mm (0.08 mm, at least 0.1 mm)".
std::string describe(const ConstraintState& state);

/// Values of the motion variables, in their order (motion.h).
inline constexpr std::size_t kMotionCount = 9;
using MotionValues = std::array<double, kMotionCount>;

/// A constraint in the numbers of one family and the motion variables, by its scale.
struct ConstraintRow {
    std::vector<std::pair<int, double>> partition;  ///< index into PartitionFamily::numbers_of, factor
    MotionValues motion = {};                       ///< factors, in the variables' order
    double low = 0, high = 0;
};
std::vector<ConstraintRow> constraint_rows(const Study& study, const PartitionFamily& family);

/// Value of a row; `numbers` = PartitionFamily::numbers_of.
template <class T>
T row_value(const ConstraintRow& row, const std::vector<T>& numbers, const MotionValues& motion) {
    double moved = 0;
    for (std::size_t i = 0; i < kMotionCount; ++i) moved += row.motion[i] * motion[i];
    T value(moved);
    for (const auto& [index, factor] : row.partition) value += factor * numbers[index];
    return value;
}

/// The point of [low, high] next to `x` at which every value lies within its bounds; the one that breaks them
/// least of those seen where there is none. `values` takes points of the box. `x` itself where it keeps them.
using ConstraintValues = std::function<std::vector<double>(const std::vector<double>&)>;
std::vector<double> nearest_kept(const ConstraintValues& values,
                                 const std::vector<std::pair<double, double>>& bounds,
                                 std::span<const double> low, std::span<const double> high,
                                 std::vector<double> x);

/// Square of the way between a point and the one evaluated for it: without it a search would see no slope
/// outside the border, and wander there.
double detour(std::span<const double> x, std::span<const double> kept);

/// `p` of a family moved to where it keeps the rows, the motion being as it is.
std::vector<double> nearest_kept(const std::vector<ConstraintRow>& rows, const PartitionFamily& family,
                                 const MotionValues& motion, std::vector<double> p);

}  // namespace gradwright
