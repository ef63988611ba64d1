#include "optimise/partition_family.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

#include "optimise/chamber_fill.h"
#include "optimise/evaluation.h"
#include "optimise/motion.h"

namespace gradwright {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
// At 90 deg the curve is no function of x. 89.5 deg runs 0.01 L_d in x over 1.1 L_d in y: finer than a grain.
constexpr double kSteepest = 89.5 * kDegree;
constexpr double kKnotFreedom = 0.45;  // of the even spacing, to either side: neighbours keep 10 % of it
constexpr double kBelow = -0.5, kAbove = 1.5;     // bounds of y over W
constexpr double kNarrowest = 0.02, kWidest = 4;  // a sigmoid's width_10_90 over L_d

/// Bounds of one parameter: fixed, the user's own, or the family's.
std::pair<double, double> box_of(const Variable& variable, double unit, double low, double high) {
    if (!variable.free) return {variable.value / unit, variable.value / unit};
    if (variable.high > variable.low) return {variable.low / unit, variable.high / unit};
    return {low, high};
}

/// Interior points where a cubic piece turns from left to right, and the knots, in order.
std::vector<double> breaks_of(const CubicOverX<double>& curve) {
    std::vector<double> breaks = {curve.x.front()};
    for (std::size_t k = 0; k + 1 < curve.x.size(); ++k) {
        // yc'' is linear in t over a piece
        const double from = curve.bend(k, 0).second, to = curve.bend(k, 1).second;
        const double t = from != to ? from / (from - to) : 0;
        if (t > 1e-3 && t < 1 - 1e-3) breaks.push_back(curve.x[k] + t * (curve.x[k + 1] - curve.x[k]));
        breaks.push_back(curve.x[k + 1]);
    }
    return breaks;
}

CubicOverX<double> cubic_through(std::span<const PlanPoint> points, bool& runs_back) {
    std::vector<double> x, y;
    for (const PlanPoint& point : points) {
        x.push_back(point.x);
        y.push_back(point.y);
    }
    runs_back = points.front().x > points.back().x;
    if (runs_back) {
        std::reverse(x.begin(), x.end());
        std::reverse(y.begin(), y.end());
    }
    return {x, y};
}

}  // namespace

std::vector<PlanPoint> spline_through(std::span<const PlanPoint> points) {
    bool runs_back = false;
    const CubicOverX<double> curve = cubic_through(points, runs_back);
    std::vector<PlanPoint> line = polyline_of(curve, breaks_of(curve));
    if (runs_back) std::reverse(line.begin(), line.end());
    return line;
}

double spline_radius(std::span<const PlanPoint> points) {
    bool runs_back = false;
    return least_radius(curvatures(cubic_through(points, runs_back)));
}

PartitionFamily::PartitionFamily(const DesignSpace& space, double length, double width,
                                 Orientation orientation)
    : family_(space.family),
      knots_(space.knots),
      monotone_(space.family == Family::spline || (space.family == Family::polyline && space.monotone)),
      length_(length),
      width_(width),
      y_low_(kBelow * width),
      y_high_(kAbove * width),
      bend_radius_(space.minimum_bend_radius),
      orientation_(orientation) {
    const auto add = [this](std::pair<double, double> box) {
        low_.push_back(box.first);
        high_.push_back(box.second);
    };
    if (family_ == Family::sigmoid) {
        add(box_of(space.centre, width, kBelow, kAbove));
        add(box_of(space.height, width, orientation.rising ? 0 : -2, orientation.rising ? 2 : 0));
        add(box_of(space.place, length, 0, 1));
        const auto [narrow, wide] = box_of(space.width_10_90, length, kNarrowest, kWidest);
        add({std::log(narrow), std::log(wide)});
        return;
    }
    if (family_ == Family::straight) {
        const Variable &angle = space.angle_deg, &offset = space.offset;
        const bool from_width = !(offset.high > offset.low);
        // A fixed number is a box of zero width; the caller leaves such parameters out of the search.
        low_ = {std::max(angle.low * kDegree, -kSteepest), from_width ? kBelow : offset.low / width};
        high_ = {std::min(angle.high * kDegree, kSteepest), from_width ? 0.5 - kBelow : offset.high / width};
        if (from_width) low_[1] = -high_[1];
        if (!angle.free) low_[0] = high_[0] = std::clamp(angle.value * kDegree, -kSteepest, kSteepest);
        if (!offset.free) low_[1] = high_[1] = offset.value / width;
        return;
    }
    if (knots_ < 2) throw std::invalid_argument("design_space.partition.knots must be at least 2");
    const double spacing = length_ / (knots_ - 1);
    if (spacing < space.minimum_segment)
        throw std::invalid_argument(
            fmt::format("design_space.partition: {} knots on {:.3g} mm stand {:.3g} mm apart, nearer than "
                        "minimum_segment = "
                        "{:.3g} mm; use at most {} knots",
                        knots_, length_ * 1e3, spacing * 1e3, space.minimum_segment * 1e3,
                        1 + int(length_ / space.minimum_segment)));
    const double freedom = std::min(kKnotFreedom, 0.5 * (1 - space.minimum_segment / spacing));
    for (int k = 0; k < knots_; ++k) {
        low_.push_back(k > 0 && monotone_ ? 0.0 : kBelow);
        high_.push_back(k > 0 && monotone_ ? 1.0 : kAbove);
    }
    for (int k = 0; family_ == Family::two_curves && k < knots_; ++k)
        add({std::min(space.clearance / width, 1.0), kAbove - kBelow});
    for (int k = 1; k + 1 < knots_; ++k) {
        low_.push_back(-freedom);
        high_.push_back(freedom);
    }
}

PartitionCurve PartitionFamily::curve(std::span<const double> p) const {
    PartitionCurve curve;
    if (family_ == Family::sigmoid) {
        const LogisticOverX<double> logistic = logistic_of(p.data());
        std::vector<double> breaks = {0, length_};
        if (logistic.place > 1e-3 * length_ && logistic.place < (1 - 1e-3) * length_)
            breaks.insert(breaks.begin() + 1, logistic.place);
        curve.points = polyline_of(logistic, breaks);
    } else {
        std::vector<double> x, y;
        knots_of(p.data(), x, y);
        if (family_ == Family::spline) {
            const CubicOverX<double> cubic(x, y);
            curve.points = polyline_of(cubic, breaks_of(cubic));
        } else {
            for (std::size_t k = 0; k < x.size(); ++k) curve.points.push_back({x[k], y[k]});
        }
        if (family_ == Family::two_curves)
            for (int k = 0; k < knots_; ++k) curve.second.push_back({x[k], y[k] + p[knots_ + k] * width_});
    }
    // A stands on the left of the direction of travel: running back puts it below. Between two curves it is
    // above the first and below the second.
    if (!orientation_.a_above)
        std::reverse(curve.points.begin(), curve.points.end());
    else
        std::reverse(curve.second.begin(), curve.second.end());
    return curve;
}

int PartitionFamily::bend_count() const {
    if (!(bend_radius_ > 0)) return 0;
    return family_ == Family::sigmoid  ? kLogisticBends
           : family_ == Family::spline ? kCubicBends * (knots_ - 1)
                                       : 0;
}

double PartitionFamily::least_bend_radius(std::span<const double> p) const {
    if (family_ == Family::sigmoid) return least_radius(curvatures(logistic_of(p.data()), length_));
    if (family_ != Family::spline) return std::numeric_limits<double>::infinity();
    std::vector<double> x, y;
    knots_of(p.data(), x, y);
    return least_radius(curvatures(CubicOverX<double>(x, y)));
}

double PartitionFamily::unsound(std::span<const double> p) const {
    if (bend_count() == 0 || least_bend_radius(p) >= bend_radius_) return 0;
    std::vector<double> excess;
    bend_excess(p.data(), excess);
    double sum = 1;
    for (const double e : excess) sum += e * e;
    return sum;
}

std::vector<double> PartitionFamily::users_start(const DesignSpace& space, std::vector<double> p) const {
    if (family_ != Family::sigmoid) return p;
    const Variable* variables[4] = {&space.centre, &space.height, &space.place, &space.width_10_90};
    const double unit[4] = {width_, width_, length_, length_};
    for (int i = 0; i < 4; ++i) {
        if (!variables[i]->free || !(variables[i]->high > variables[i]->low)) continue;
        p[i] = variables[i]->value / unit[i];
        if (i == 3) p[i] = std::log(p[i]);
    }
    return p;
}

void PartitionFamily::clip(std::span<double> p) const {
    for (std::size_t i = 0; i < size(); ++i) p[i] = std::clamp(p[i], low_[i], high_[i]);
}

std::vector<double> PartitionFamily::hat_heights(std::span<const PlanPoint> samples) const {
    const int knots = this->knots();
    const double spacing = length_ / (knots - 1);
    // Least squares for knot heights at even x (hat functions), with a weak pull to straightness for knots
    // without samples.
    Eigen::MatrixXd normal = Eigen::MatrixXd::Zero(knots, knots);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(knots);
    for (const PlanPoint& sample : samples) {
        const int k = std::clamp(int(sample.x / spacing), 0, knots - 2);
        const double t = sample.x / spacing - k;
        const double hat[2] = {1 - t, t};
        for (int i = 0; i < 2; ++i) {
            for (int j = 0; j < 2; ++j) normal(k + i, k + j) += hat[i] * hat[j];
            right(k + i) += hat[i] * sample.y;
        }
    }
    const double pull = 1e-3 * std::max<double>(1, samples.size());
    for (int k = 1; k + 1 < knots; ++k) {
        const int at[3] = {k - 1, k, k + 1};
        const double bend[3] = {1, -2, 1};
        for (int i = 0; i < 3; ++i)
            for (int j = 0; j < 3; ++j) normal(at[i], at[j]) += pull * bend[i] * bend[j];
    }
    const Eigen::VectorXd height = normal.ldlt().solve(right);
    return {height.data(), height.data() + knots};
}

// The two numbers in which the logistic is linear by least squares, the other two by trying: the start of a
// search needs no more.
std::vector<double> PartitionFamily::fit_logistic(std::span<const PlanPoint> samples) const {
    constexpr int kTried = 21;  // per number, over its box and then around the best
    std::vector<double> best, low = low_, high = high_;
    double least = std::numeric_limits<double>::infinity();
    for (int trial = 0; trial < 2 * kTried * kTried; ++trial) {
        if (trial == kTried * kTried)
            for (const int n : {2, 3}) {
                const double step = (high_[n] - low_[n]) / (kTried - 1);
                low[n] = std::max(low_[n], best[n] - step);
                high[n] = std::min(high_[n], best[n] + step);
            }
        const int i = trial % kTried, j = trial / kTried % kTried;
        std::vector<double> p = {0, 1 / width_, low[2] + (high[2] - low[2]) * i / (kTried - 1),
                                 low[3] + (high[3] - low[3]) * j / (kTried - 1)};
        const LogisticOverX<double> unit = logistic_of(p.data());  // centre 0, height 1 m
        double n = 0, s = 0, ss = 0, y = 0, sy = 0, widening = 1;
        std::vector<double> shape;
        for (const PlanPoint& sample : samples) {
            double value = 0;
            unit.evaluate(sample.x, value, widening);
            shape.push_back(value);
            n += 1;
            s += value;
            ss += value * value;
            y += sample.y;
            sy += value * sample.y;
        }
        const double spread = n * ss - s * s;
        const double height = spread > 1e-12 * n * n ? (n * sy - s * y) / spread : 0;
        p[1] = std::clamp(height / width_, low_[1], high_[1]);
        p[0] = std::clamp((y - p[1] * width_ * s) / (std::max(n, 1.0) * width_), low_[0], high_[0]);
        double square = 0;
        for (std::size_t k = 0; k < samples.size(); ++k) {
            const double off = p[0] * width_ + p[1] * width_ * shape[k] - samples[k].y;
            square += off * off;
        }
        // relative to the width: a shape that cannot be bent comes last
        square = square / (std::max(n, 1.0) * width_ * width_) + unsound(p);
        if (best.empty() || square < least) {
            least = square;
            best = p;
        }
    }
    return best;
}

std::vector<double> PartitionFamily::fit_samples(std::span<const PlanPoint> first,
                                                 std::span<const PlanPoint> second) const {
    const std::vector<double> low = hat_heights(first), high = hat_heights(second);
    std::vector<double> p(size(), 0.0);
    for (int k = 0; k < knots_; ++k) {
        p[k] = std::clamp(low[k] / width_, low_[k], high_[k]);
        p[knots_ + k] = high[k] / width_ - p[k];
    }
    clip(p);
    return p;
}

std::vector<double> PartitionFamily::fit_samples(std::span<const PlanPoint> samples) const {
    if (family_ == Family::sigmoid) return fit_logistic(samples);
    const int knots = this->knots();
    const std::vector<double> height = hat_heights(samples);
    std::vector<double> p(size(), 0.0);
    if (family_ == Family::straight) {
        p[0] = std::atan2(height[1] - height[0], length_);
        p[1] = (0.5 * (height[0] + height[1]) - 0.5 * width_) / width_;
    } else {
        double y = std::clamp(height[0], y_low_, y_high_);
        p[0] = y / width_;
        for (int k = 1; k < knots; ++k) {
            if (!monotone_) {
                p[k] = height[k] / width_;
                continue;
            }
            const double bound = orientation_.rising ? y_high_ : y_low_;
            const double left = bound - y;
            p[k] = std::abs(left) > 1e-12 ? std::clamp((height[k] - y) / left, 0.0, 1.0) : 0.0;
            y += p[k] * left;
        }
    }
    clip(p);
    return p;
}

std::vector<std::string> PartitionFamily::number_names() const {
    if (family_ == Family::straight) return {"angle", "offset"};
    if (family_ == Family::sigmoid) return {"centre", "height", "place", "width_10_90"};
    std::vector<std::string> names;
    for (int k = 0; k < knots_; ++k) {
        names.push_back(fmt::format("x{}", k));
        names.push_back(fmt::format("y{}", k));
        if (family_ == Family::two_curves) names.push_back(fmt::format("gap{}", k));
    }
    return names;
}

std::vector<std::pair<std::string, double>> PartitionFamily::named(std::span<const double> p) const {
    std::vector<std::pair<std::string, double>> numbers;
    const std::vector<std::string> names = number_names();
    std::vector<double> values;
    numbers_of(p.data(), values);
    for (std::size_t i = 0; i < names.size(); ++i)
        if (names[i] == "angle")
            numbers.emplace_back("angle_deg", values[i] / kDegree);
        else
            numbers.emplace_back(names[i] + "_m", values[i]);
    // beyond a kilometre it is the rounding of a straight line
    if (const double radius = least_bend_radius(p); radius < 1e3)
        numbers.emplace_back("least_bend_radius_m", radius);
    if (!orientation_.a_above)
        numbers.emplace_back(family_ == Family::two_curves ? "b_between" : "a_below", 1);
    return numbers;
}

namespace {

/// Sign of the weighted covariance of the target with `along` (y of a bin's centre), over the bins that
/// count.
bool goes_with(const Study& study, const std::function<double(double)>& along) {
    const std::vector<double> target = bin_targets(study);
    const std::vector<double> weight = bin_weights(study);
    double sum = 0, sum_y = 0, sum_g = 0, sum_yg = 0;
    for (int b = 0; b < study.bins.count; ++b) {
        const double y = along(study.bins.centre(b));
        sum += weight[b];
        sum_y += weight[b] * y;
        sum_g += weight[b] * target[b];
        sum_yg += weight[b] * y * target[b];
    }
    return sum * sum_yg - sum_y * sum_g >= 0;
}

/// The chambers as the study starts.
ChamberFill fill_of(const Study& study) {
    Design start;
    for (const MotionVariable& motion : kMotionVariables)
        motion.of(start) = motion.in(study.design_space).value;
    return chamber_fill(study, start);
}

}  // namespace

bool target_rises(const Study& study) {
    return goes_with(study, [](double y) { return y; });
}

bool target_peaks(const Study& study) {
    const std::vector<double> weight = bin_weights(study);
    double sum = 0, sum_y = 0;
    for (int b = 0; b < study.bins.count; ++b) {
        sum += weight[b];
        sum_y += weight[b] * study.bins.centre(b);
    }
    const double middle = sum > 0 ? sum_y / sum : 0.5 * study.dispenser_width;
    return goes_with(study, [middle](double y) { return -std::abs(y - middle); });
}

bool stands_above(const Study& study, const DesignSpace& space) {
    if (space.family == Family::straight && !space.angle_deg.free) return true;
    if (space.family == Family::sigmoid && !space.partition_free) return true;
    return space.family == Family::two_curves ? target_peaks(study) : target_rises(study);
}

std::vector<PlanPoint> closed_form_curve(const Study& study, Orientation orientation,
                                         const std::function<double(double share)>& quantile, Fold fold) {
    const bool platform_side = orientation.rising != orientation.a_above;
    const double width = study.dispenser_width;
    const int steps = 800;  // in y: 4 um on a 1.6 mm dispenser, under a tenth of a grain
    const int samples = 200;
    const ChamberFill fill = fill_of(study);
    const auto target_at = [&](double y) {
        const double g = fill.side_share(study.target(y));
        return orientation.a_above ? g : 1 - g;  // a falling target's mirror rises
    };
    std::vector<PlanPoint> curve;
    for (int i = 0; i < samples; ++i) {
        const double q = (i + 0.5) / samples;
        const double from_middle = 2 * std::abs(q - 0.5);
        const double share_above = fold == Fold::valley  ? from_middle
                                   : fold == Fold::ridge ? 1 - from_middle
                                   : platform_side       ? 1 - q
                                                         : q;
        const double share = orientation.a_above ? share_above : 1 - share_above;
        // first y where the rising form of g reaches the share: inverse of a clamped, possibly stepping
        // function
        double y = kAbove * width;
        for (int j = 0; j <= steps; ++j) {
            const double at = width * (kBelow + (kAbove - kBelow) * j / steps);
            if (target_at(at) >= share) {
                y = at;
                break;
            }
        }
        curve.push_back({quantile(q), y});
    }
    return curve;
}

std::vector<double> closed_form_start(const Study& study, const PartitionFamily& family,
                                      const std::function<double(double share)>& quantile, Fold fold) {
    if (family.family() != Family::two_curves)
        return family.fit_samples(closed_form_curve(study, family.orientation(), quantile, fold));
    const double width = study.dispenser_width;
    const int steps = 800, samples = 200;  // as above
    const ChamberFill fill = fill_of(study);
    std::vector<double> height, inner;
    for (int j = 0; j <= steps; ++j) {
        height.push_back(width * (kBelow + (kAbove - kBelow) * j / steps));
        const double g = fill.side_share(study.target(height.back()));
        inner.push_back(family.orientation().a_above ? g : 1 - g);
    }
    // what no height asks for closes the band where the most is asked for
    const auto most = std::max_element(inner.begin(), inner.end());
    const auto most_end = std::find_if(most, inner.end(), [&](double share) { return share < *most - 1e-9; });
    const double closed = 0.5 * (height[most - inner.begin()] + height[most_end - inner.begin() - 1]);
    const auto reaches = [](double share) { return [share](double has) { return has >= share; }; };
    std::vector<PlanPoint> first, second;
    for (int i = 0; i < samples; ++i) {
        const double q = (i + 0.5) / samples;
        const double share = family.orientation().rising ? q : 1 - q;
        const double other = fold == Fold::none ? share : 1 - share;
        const auto lower = std::find_if(inner.begin(), inner.end(), reaches(share));
        const auto upper = std::find_if(inner.rbegin(), inner.rend(), reaches(other));
        first.push_back({quantile(q), lower == inner.end() ? closed : height[lower - inner.begin()]});
        second.push_back({quantile(q), upper == inner.rend() ? closed : height[inner.rend() - upper - 1]});
    }
    return family.fit_samples(first, second);
}

}  // namespace gradwright
