#include "optimise/partition_family.h"

#include <fmt/format.h>

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>

#include "optimise/evaluation.h"

namespace gradwright {
namespace {

constexpr double kDegree = std::numbers::pi / 180;
// At 90 deg the curve is no function of x. 89.5 deg runs 0.01 L_d in x over 1.1 L_d in y: finer than a grain.
constexpr double kSteepest = 89.5 * kDegree;
constexpr double kKnotFreedom = 0.45;  // of the even spacing, to either side: neighbours keep 10 % of it
constexpr double kBelow = -0.5, kAbove = 1.5;  // bounds of y over W

}  // namespace

PartitionFamily::PartitionFamily(const DesignSpace& space, double length, double width,
                                 Orientation orientation)
    : family_(space.family),
      knots_(space.knots),
      monotone_(space.monotone),
      length_(length),
      width_(width),
      y_low_(kBelow * width),
      y_high_(kAbove * width),
      orientation_(orientation) {
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
    for (int k = 1; k + 1 < knots_; ++k) {
        low_.push_back(-freedom);
        high_.push_back(freedom);
    }
}

PartitionCurve PartitionFamily::curve(std::span<const double> p) const {
    std::vector<double> x, y;
    knots_of(p.data(), x, y);
    PartitionCurve curve;
    for (std::size_t k = 0; k < x.size(); ++k) curve.points.push_back({x[k], y[k]});
    // A stands on the left of the direction of travel: running back puts it below.
    if (!orientation_.a_above) std::reverse(curve.points.begin(), curve.points.end());
    return curve;
}

void PartitionFamily::clip(std::span<double> p) const {
    for (std::size_t i = 0; i < size(); ++i) p[i] = std::clamp(p[i], low_[i], high_[i]);
}

std::vector<double> PartitionFamily::fit_samples(std::span<const PlanPoint> samples) const {
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

    std::vector<double> p(size(), 0.0);
    if (family_ == Family::straight) {
        p[0] = std::atan2(height(1) - height(0), length_);
        p[1] = (0.5 * (height(0) + height(1)) - 0.5 * width_) / width_;
    } else {
        double y = std::clamp(height(0), y_low_, y_high_);
        p[0] = y / width_;
        for (int k = 1; k < knots; ++k) {
            if (!monotone_) {
                p[k] = height(k) / width_;
                continue;
            }
            const double bound = orientation_.rising ? y_high_ : y_low_;
            const double left = bound - y;
            p[k] = std::abs(left) > 1e-12 ? std::clamp((height(k) - y) / left, 0.0, 1.0) : 0.0;
            y += p[k] * left;
        }
    }
    clip(p);
    return p;
}

std::vector<std::pair<std::string, double>> PartitionFamily::named(std::span<const double> p) const {
    std::vector<std::pair<std::string, double>> numbers;
    if (family_ == Family::straight) {
        numbers = {{"angle_deg", p[0] / kDegree}, {"offset_m", p[1] * width_}};
    } else {
        std::vector<double> x, y;
        knots_of(p.data(), x, y);
        for (std::size_t k = 0; k < x.size(); ++k) {
            numbers.emplace_back(fmt::format("x{}_m", k), x[k]);
            numbers.emplace_back(fmt::format("y{}_m", k), y[k]);
        }
    }
    if (!orientation_.a_above) numbers.emplace_back("a_below", 1);
    return numbers;
}

bool target_rises(const Study& study) {
    const std::vector<double> target = bin_targets(study);
    const std::vector<double> weight = bin_weights(study);
    double sum = 0, sum_y = 0, sum_g = 0, sum_yg = 0;
    for (int b = 0; b < study.bins.count; ++b) {
        const double y = study.bins.centre(b);
        sum += weight[b];
        sum_y += weight[b] * y;
        sum_g += weight[b] * target[b];
        sum_yg += weight[b] * y * target[b];
    }
    // sign of the weighted covariance of y and g
    return sum * sum_yg - sum_y * sum_g >= 0;
}

std::vector<PlanPoint> closed_form_curve(const Study& study, Orientation orientation,
                                         const std::function<double(double share)>& quantile, Fold fold) {
    const bool platform_side = orientation.rising != orientation.a_above;
    const double width = study.dispenser_width;
    const int steps = 800;  // in y: 4 um on a 1.6 mm dispenser, under a tenth of a grain
    const int samples = 200;
    const auto target_at = [&](double y) {
        const double g = std::clamp(study.target(y), 0.0, 1.0);
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

}  // namespace gradwright
