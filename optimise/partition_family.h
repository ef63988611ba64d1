// Partition families: parameter vector <-> curve in the dispenser (inverse-design.md, Variables).
//
//   straight  p = (angle [rad], offset / W): line at `angle` from +x through the dispenser's centre moved by
//   the offset in y. polyline  K knots, x_0 = 0, x_{K-1} = L_d. Interior knots x_k = (k + s_k) L_d / (K - 1)
//   with |s_k| <= 0.45, and never so far that
//             two knots come nearer than the minimum segment: the order holds by construction.
//             free:     p = (y_0/W .. y_{K-1}/W, s_1 .. s_{K-2})
//             monotone: p = (y_0/W, f_1 .. f_{K-1}, s_1 .. s_{K-2}), 0 <= f_k <= 1: knot k goes the share f_k
//             of the way that is
//                       left to the bound, y_k = y_{k-1} + f_k (bound - y_{k-1}). A box in p is then exactly
//                       "monotone and within the bounds"; increments y_k - y_{k-1} >= 0 would need a sum
//                       constraint, which bounded least squares has not.
//
// Parameters have no unit and span about one, so that one trust region suits all. Bounds come from the
// dispenser: y within
// [-0.5 W, 1.5 W], because a curve may leave through the side walls. The two orientations are part of the
// family's shape, not of p:
//   a_above   A is powder at larger y (curve runs in +x). false: the mirrored curve, running in -x, for
//   targets that fall along y. rising    direction of a monotone polyline: y grows (true) or falls (false)
//   with x. Linear 0 -> 1 ramp: falls.
// Of two curves a_above says that A stands between them, and `rising` towards which end the band narrows.
#pragma once
#include <cmath>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "dem/homogeneous_estimator.h"
#include "optimise/plan_curve.h"
#include "optimise/study.h"

namespace gradwright {

struct Orientation {
    bool a_above = true;
    bool rising = false;
};

class PartitionFamily {
  public:
    /// `length`, `width` of the dispenser [m] > 0. Throws std::invalid_argument when the minimum segment
    /// leaves no room for the knots.
    PartitionFamily(const DesignSpace& space, double length, double width, Orientation orientation);

    std::size_t size() const { return low_.size(); }
    int knots() const { return family_ == Family::straight ? 2 : knots_; }
    const std::vector<double>& low() const { return low_; }
    const std::vector<double>& high() const { return high_; }
    Family family() const { return family_; }
    Orientation orientation() const { return orientation_; }

    /// Knots [m] with x rising from 0 to L_d (of the first curve; a sigmoid has none); T = double or
    /// ceres::Jet.
    template <class T>
    void knots_of(const T* p, std::vector<T>& x, std::vector<T>& y) const;
    /// Calls visit(curve, sign) with what smooth_profile_above takes: the share above the partition, or
    /// between its curves, is the sum of sign times the share above each.
    template <class T, class Visit>
    void visit_curves(const T* p, Visit&& visit) const;
    /// Appends max(0, 1.1 R k - 1) of each curvature k that is looked at, R = minimum_bend_radius: bend_count
    /// numbers.
    template <class T>
    void bend_excess(const T* p, std::vector<T>& out) const;
    int bend_count() const;
    /// [m]; infinite where nothing is bent.
    double least_bend_radius(std::span<const double> p) const;
    /// What is added to an objective, square of GI: 0 for what can be bent, else 1 and the squares of
    /// bend_excess.
    double unsound(std::span<const double> p) const;
    /// `p` with the user's own starts for a sigmoid's numbers that have bounds of their own.
    std::vector<double> users_start(const DesignSpace& space, std::vector<double> p) const;
    /// Curve with A on the side asked for; a smooth one as a polyline within kChordError.
    PartitionCurve curve(std::span<const double> p) const;
    /// Nearest parameters, in the least squares sense, to the curve y(x) given as samples with x rising [m];
    /// within the bounds.
    std::vector<double> fit_samples(std::span<const PlanPoint> samples) const;
    /// The same of two curves.
    std::vector<double> fit_samples(std::span<const PlanPoint> first,
                                    std::span<const PlanPoint> second) const;
    /// Clips p to the bounds: optimisers leave them by round-off.
    void clip(std::span<double> p) const;
    /// The family's own numbers in the order of `named`, without its units and additions: "angle", "x0", "y0"
    /// ...
    std::vector<std::string> number_names() const;
    /// Those numbers [rad, m]; T = double or ceres::Jet.
    template <class T>
    void numbers_of(const T* p, std::vector<T>& numbers) const;
    /// The design's numbers for people: straight: angle [deg], offset [m]; polyline: x_k, y_k [m]. A mirrored
    /// curve says so.
    std::vector<std::pair<std::string, double>> named(std::span<const double> p) const;

  private:
    template <class T>
    LogisticOverX<T> logistic_of(const T* p) const;
    std::vector<double> fit_logistic(std::span<const PlanPoint> samples) const;
    std::vector<double> hat_heights(std::span<const PlanPoint> samples) const;

    Family family_;
    int knots_;
    bool monotone_;
    double length_, width_, y_low_, y_high_, bend_radius_;
    Orientation orientation_;
    std::vector<double> low_, high_;
};

template <class T>
void PartitionFamily::knots_of(const T* p, std::vector<T>& x, std::vector<T>& y) const {
    x.clear();
    y.clear();
    if (family_ == Family::straight) {
        using std::tan;
        const T rise = tan(p[0]) * (0.5 * length_);
        const T middle = 0.5 * width_ + p[1] * width_;
        x = {T(0.0), T(length_)};
        y = {middle - rise, middle + rise};
        return;
    }
    const double spacing = length_ / (knots_ - 1);
    const int shifts = family_ == Family::two_curves ? 2 * knots_ : knots_;
    for (int k = 0; k < knots_; ++k) {
        const bool interior = k > 0 && k < knots_ - 1;
        x.push_back(interior ? (p[shifts + k - 1] + double(k)) * spacing : T(k * spacing));
        if (k == 0 || !monotone_) {
            y.push_back(p[k] * width_);
        } else {
            const double bound = orientation_.rising ? y_high_ : y_low_;
            y.push_back(y.back() + p[k] * (bound - y.back()));
        }
    }
}

template <class T>
void PartitionFamily::numbers_of(const T* p, std::vector<T>& numbers) const {
    using std::exp;
    numbers.clear();
    if (family_ == Family::straight) {
        numbers = {p[0], p[1] * width_};
        return;
    }
    if (family_ == Family::sigmoid) {
        numbers = {p[0] * width_, p[1] * width_, p[2] * length_, exp(p[3]) * length_};
        return;
    }
    std::vector<T> x, y;
    knots_of(p, x, y);
    for (std::size_t k = 0; k < x.size(); ++k) {
        numbers.push_back(x[k]);
        numbers.push_back(y[k]);
        if (family_ == Family::two_curves) numbers.push_back(p[knots_ + k] * width_);
    }
}

template <class T>
LogisticOverX<T> PartitionFamily::logistic_of(const T* p) const {
    using std::exp;
    const double rate = 2 * std::log(9.0) / length_;
    return {p[0] * width_, p[1] * width_, p[2] * length_, rate * exp(-p[3])};
}

template <class T, class Visit>
void PartitionFamily::visit_curves(const T* p, Visit&& visit) const {
    if (family_ == Family::sigmoid) {
        visit(logistic_of(p), 1.0);
        return;
    }
    std::vector<T> x, y;
    knots_of(p, x, y);
    if (family_ == Family::spline) {
        visit(CubicOverX<T>(x, y), 1.0);
        return;
    }
    visit(CurveOverX<T>(x, y), 1.0);
    if (family_ != Family::two_curves) return;
    for (int k = 0; k < knots_; ++k) y[k] += p[knots_ + k] * width_;
    visit(CurveOverX<T>(x, y), -1.0);
}

template <class T>
void PartitionFamily::bend_excess(const T* p, std::vector<T>& out) const {
    if (bend_count() == 0) return;
    constexpr double kOnset = 1.1;  // so that a design at rest against the cost stays on the sound side
    std::vector<T> x, y, curvature;
    if (family_ == Family::sigmoid) {
        curvature = curvatures(logistic_of(p), length_);
    } else {
        knots_of(p, x, y);
        curvature = curvatures(CubicOverX<T>(x, y));
    }
    for (const T& k : curvature) {
        const T excess = kOnset * bend_radius_ * k - 1.0;
        out.push_back(excess > 0.0 ? excess : T(0.0));
    }
}

/// Does the target rise along y over the bins that count? Decides on which side A stands. Flat targets count
/// as rising.
bool target_rises(const Study& study);
/// Is GI larger in the middle of the bins that count than towards their ends? A flat target counts as such.
bool target_peaks(const Study& study);
/// Where A stands (Orientation::a_above): a partition that the user has fixed (of a straight one, its angle)
/// keeps its meaning, A on the left; else the target decides.
bool stands_above(const Study& study, const DesignSpace& space);

/// The curve in closed form (inverse-design.md): with W the volume-weighted distribution of origin_x, x_p(y)
/// = W^-1(1 - g(y)) with A on the platform side, x_p(y) = W^-1(g(y)) with A on the dispenser's back side (the
/// opposite slope). Given as y_p(x), samples at equal steps of W, so that a plateau of g, which every y at
/// the end of the curve would satisfy, weighs nothing. `quantile` = W^-1 [m] (fully mixed dispenser: share *
/// L_d). Shares that g never reaches let the curve leave through the side, at -0.5 W or 1.5 W.
/// Folded forms: at height y A holds the origins between the quantiles (1 - g)/2 and (1 + g)/2 (`valley`: A
/// opens from the middle of W) or outside g/2 and 1 - g/2 (`ridge`: from both ends). Both lay the same
/// profile; what each x takes too much of from one end it takes too little of from the other, so a shift of
/// the origins along x cancels to first order.
enum class Fold { none, valley, ridge };
std::vector<PlanPoint> closed_form_curve(const Study& study, Orientation orientation,
                                         const std::function<double(double share)>& quantile,
                                         Fold fold = Fold::none);

/// The closed form as parameters of the family. Two curves: at the share q of W the band holds the y where g
/// (or 1 - g, with B between) is at least 1 - q or q; with a fold, 1 - q on one of its sides and q on the
/// other, so that the band runs askew.
std::vector<double> closed_form_start(const Study& study, const PartitionFamily& family,
                                      const std::function<double(double share)>& quantile,
                                      Fold fold = Fold::none);

}  // namespace gradwright
