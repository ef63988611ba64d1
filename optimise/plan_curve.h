// Smooth partitions y = yc(x), for the estimator with any number type (double, or ceres::Jet for
// derivatives), and the polyline that the DEM, the drawing and the files hold in their stead.
//
//   LogisticOverX  y = centre + height (s(rate (x - place)) - 1/2), s(u) = 1/(1 + e^-u)
//                  rate = 2 ln 9 / width_10_90: from 10 to 90 % of the height over that way in x
//   CubicOverX     cubic Hermite pieces through knots, slopes by Fritsch and Butland (SIAM J. Sci. Stat.
//                  Comput. 5 (1984) 300): weighted harmonic mean of the two neighbouring segments, 0 where
//                  they disagree in sign; ends by the limited three-point formula. Each slope is then at most
//                  three times either neighbour's, which is enough for a monotone piece (Fritsch and Carlson,
//                  SIAM J. Numer. Anal. 17 (1980) 238): monotone knots give a monotone curve.
//
// Bend radius R = (1 + yc'^2)^(3/2) / |yc''|. A cubic's yc'' jumps at a knot: the tighter side counts.
#pragma once
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "dem/partition.h"

namespace gradwright {

/// Largest distance of a smooth partition from the polyline that stands in for it [m]: a twentieth of the
/// median grain, and below what a workshop bends.
inline constexpr double kChordError = 2e-6;

/// yc' [-] and yc'' [1/m] at one place.
template <class T>
struct Bend {
    T slope, second;
    T curvature() const {
        using std::abs;
        using std::sqrt;
        const T stretch = 1.0 + slope * slope;
        return abs(second) / (stretch * sqrt(stretch));
    }
};

template <class T>
struct LogisticOverX {
    T centre, height, place, rate;  ///< [m], [m], [m], [1/m] > 0

    /// s(u) without overflow at either end.
    static T share(const T& u) {
        using std::exp;
        if (u < 0.0) {
            const T e = exp(u);
            return e / (1.0 + e);
        }
        return 1.0 / (1.0 + exp(-u));
    }
    /// yc(at) [m] and H/h = sqrt(1 + yc'^2), as CurveOverX.
    void evaluate(double at, T& yc, T& widening) const {
        using std::sqrt;
        const T s = share(rate * (at - place));
        yc = centre + height * (s - 0.5);
        const T slope = height * rate * s * (1.0 - s);
        widening = sqrt(1.0 + slope * slope);
    }
    /// At u = rate (x - place).
    Bend<T> bend(double u) const {
        const T s = share(T(u)), hump = s * (1.0 - s);
        return {height * rate * hump, height * rate * rate * hump * (1.0 - 2.0 * s)};
    }
};

template <class T>
struct CubicOverX {
    std::vector<T> x, y, slope;  ///< knots [m], x strictly rising, >= 2; slopes there [-]

    CubicOverX(std::vector<T> knot_x, std::vector<T> knot_y)
        : x(std::move(knot_x)), y(std::move(knot_y)), slope(x.size(), T(0.0)) {
        const std::size_t n = x.size();
        std::vector<T> h, d;
        for (std::size_t k = 0; k + 1 < n; ++k) {
            h.push_back(x[k + 1] - x[k]);
            d.push_back((y[k + 1] - y[k]) / h[k]);
        }
        if (n == 2) {
            slope = {d[0], d[0]};
            return;
        }
        for (std::size_t k = 1; k + 1 < n; ++k) {
            if (!(d[k - 1] * d[k] > 0.0)) continue;
            const T w1 = 2.0 * h[k] + h[k - 1], w2 = h[k] + 2.0 * h[k - 1];
            slope[k] = (w1 + w2) / (w1 / d[k - 1] + w2 / d[k]);
        }
        const auto end = [](const T& h0, const T& h1, const T& d0, const T& d1) {
            const T m = ((2.0 * h0 + h1) * d0 - h0 * d1) / (h0 + h1);
            if (!(m * d0 > 0.0)) return T(0.0);
            // |m| > 3 |d0| can only be where the segments disagree
            return !(d0 * d1 > 0.0) && m * m > 9.0 * d0 * d0 ? T(3.0 * d0) : m;
        };
        slope.front() = end(h[0], h[1], d[0], d[1]);
        slope.back() = end(h[n - 2], h[n - 3], d[n - 2], d[n - 3]);
    }

    /// yc(at) [m] and H/h = sqrt(1 + yc'^2); straight on beyond the ends.
    void evaluate(double at, T& yc, T& widening) const {
        using std::sqrt;
        T m;
        if (at <= x.front() || at >= x.back()) {
            const std::size_t k = at <= x.front() ? 0 : x.size() - 1;
            m = slope[k];
            yc = y[k] + m * (at - x[k]);
        } else {
            std::size_t k = 0;
            while (at >= x[k + 1]) ++k;
            const T h = x[k + 1] - x[k], t = (at - x[k]) / h, d = (y[k + 1] - y[k]) / h;
            const T b = 3.0 * d - 2.0 * slope[k] - slope[k + 1], c = slope[k] + slope[k + 1] - 2.0 * d;
            yc = y[k] + h * t * (slope[k] + t * (b + t * c));
            m = slope[k] + t * (2.0 * b + 3.0 * c * t);
        }
        widening = sqrt(1.0 + m * m);
    }
    /// In piece k at the share t of its way.
    Bend<T> bend(std::size_t k, double t) const {
        const T h = x[k + 1] - x[k], d = (y[k + 1] - y[k]) / h;
        const T b = 3.0 * d - 2.0 * slope[k] - slope[k + 1], c = slope[k] + slope[k + 1] - 2.0 * d;
        return {slope[k] + t * (2.0 * b + 3.0 * t * c), (2.0 * b + 6.0 * t * c) / h};
    }
};

/// Polyline on the curve from the first of `breaks` to the last (x strictly rising), bisected in x until no
/// piece stands further than kChordError from the curve. Breaks: the ends, and wherever the curve turns from
/// left to right, since a piece around such a point may meet its chord in the middle.
template <class Curve>
std::vector<PlanPoint> polyline_of(const Curve& curve, std::span<const double> breaks) {
    const auto on = [&curve](double x) {
        double yc = 0, widening = 1;
        curve.evaluate(x, yc, widening);
        return PlanPoint{x, yc};
    };
    // seven looks a piece; 0.9: between them the curve may stand off a little more
    const auto stands_off = [&on](const PlanPoint& a, const PlanPoint& b) {
        const double length = std::hypot(b.x - a.x, b.y - a.y);
        for (int i = 1; i < 8; ++i) {
            const PlanPoint p = on(a.x + (b.x - a.x) * i / 8);
            const double height = (b.x - a.x) * (p.y - a.y) - (b.y - a.y) * (p.x - a.x);
            if (std::abs(height) > 0.9 * kChordError * length) return true;
        }
        return false;
    };
    std::vector<PlanPoint> line = {on(breaks.front())};
    constexpr int kDeepest = 24;  // bisections: 6e-8 of the way, far below any grain
    const auto add = [&](auto&& self, const PlanPoint& a, const PlanPoint& b, int depth) -> void {
        if (depth < kDeepest && stands_off(a, b)) {
            const PlanPoint middle = on(0.5 * (a.x + b.x));
            self(self, a, middle, depth + 1);
            self(self, middle, b, depth + 1);
            return;
        }
        line.push_back(b);
    };
    for (std::size_t k = 0; k + 1 < breaks.size(); ++k) add(add, on(breaks[k]), on(breaks[k + 1]), 0);
    return line;
}

/// u = rate (x - place) at which a logistic's bend is looked at: beyond 8 the curve is flat to 3e-4 of its
/// height. Steps of 0.25 miss the tightest bend by less than 1 %.
inline constexpr double kBendReach = 8, kBendStep = 0.25;
inline constexpr int kLogisticBends = 65;
/// Looks at each piece of a cubic, both ends included.
inline constexpr int kCubicBends = 9;

/// Curvature [1/m] at each look; a logistic's outside 0 <= x <= length do not count (0).
template <class T>
std::vector<T> curvatures(const LogisticOverX<T>& curve, double length) {
    std::vector<T> all;
    for (int i = 0; i < kLogisticBends; ++i) {
        const double u = -kBendReach + kBendStep * i;
        const T x = curve.place + u / curve.rate;
        all.push_back(x >= 0.0 && x <= length ? curve.bend(u).curvature() : T(0.0));
    }
    return all;
}
template <class T>
std::vector<T> curvatures(const CubicOverX<T>& curve) {
    std::vector<T> all;
    for (std::size_t k = 0; k + 1 < curve.x.size(); ++k)
        for (int i = 0; i < kCubicBends; ++i)
            all.push_back(curve.bend(k, double(i) / (kCubicBends - 1)).curvature());
    return all;
}
/// Tightest bend [m]; infinite for a straight line.
inline double least_radius(std::span<const double> curvature) {
    double most = 0;
    for (const double k : curvature) most = std::max(most, k);
    return most > 0 ? 1 / most : std::numeric_limits<double>::infinity();
}

/// Monotone spline through given points, in their order (A on the left), as its polyline. x must rise or fall
/// strictly.
std::vector<PlanPoint> spline_through(std::span<const PlanPoint> points);
/// Its tightest bend [m].
double spline_radius(std::span<const PlanPoint> points);

}  // namespace gradwright
