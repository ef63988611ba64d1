// The wish: gradation index GI(y), or GI(x, y), asked for, over plain numbers. Knows no grains.
#pragma once
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gradwright {

enum class TargetShape { linear, sigmoid, step, table, plateaus, aba, field };

/// A stretch of constant GI. The first reaches down to every y and the last up to every y.
struct Plateau {
    double gi = 0;            ///< [-] in 0 .. 1
    double from = 0, to = 0;  ///< [m], from <= to; the first has no use for `from`, the last none for `to`
};

struct TargetZone {
    double y_low = 0, y_high = 0;  ///< [m], half-open [low, high)
    double weight = 1;             ///< >= 0; 0 = don't care
    /// [m], half-open; a field alone knows other ends than these
    double x_low = -std::numeric_limits<double>::infinity(), x_high = std::numeric_limits<double>::infinity();
};

/// g(y) in [0, 1]. Build with the functions below. A field is g(x, y): asked for one y it answers with its
/// mean over a range of x (`over_x`), so that whoever wants a profile sees one.
struct Target {
    TargetShape shape = TargetShape::linear;
    // linear: clamped ramp through (y0, gi0), (y1, gi1); step: gi0 below y0, gi1 from y0 on
    double y0 = 0, gi0 = 0, y1 = 0, gi1 = 1;
    // sigmoid: gi0 + (gi1-gi0)/(1+exp(-(y-centre)/s)), s = width_10_90 / (2 ln 9)
    double centre = 0, width_10_90 = 0;
    // table, plateaus, aba: piecewise linear, constant beyond its ends
    std::vector<double> table_y, table_gi;
    std::string table_file;         ///< as given, for the report
    std::vector<TargetZone> zones;  ///< later zones win; outside all zones weight 1
    // field: bilinear on the grid field_x x table_y, constant beyond its edges; row-major [y][x]
    std::vector<double> field_x;  ///< from the platform's near edge, footprint not shifted [m]
    std::vector<double> field_gi;
    std::vector<double> field_weight;  ///< empty = 1; each holds from its point to the next in x and in y

    double operator()(double y) const;
    /// Mean of g over [low, high): what a bin of that width can show [-].
    double bin_mean(double y_low, double y_high) const;
    double weight(double y) const;
    bool is_field() const { return shape == TargetShape::field; }
    /// g(x, y) of a field; g(y) of the others.
    double at(double x, double y) const;
    /// A field's mean over [x_low, x_high) as a function of y, by its table; the others as they are.
    Target over_x(double x_low, double x_high) const;
    double weight(double x, double y) const;
    /// Mean and least of the weight over a rectangle: exact, it is piecewise constant.
    struct Weight {
        double mean = 1, least = 1;
    };
    Weight weight_over(double x_low, double x_high, double y_low, double y_high) const;
    /// Smallest and largest GI of the shape [-].
    std::pair<double, double> gi_range() const;
    std::string describe() const;  ///< one line for people, lengths in mm
};

Target linear_target(double y0, double gi0, double y1, double gi1);
Target sigmoid_target(double centre, double width_10_90, double gi_low = 0, double gi_high = 1);
Target step_target(double y, double gi_low = 0, double gi_high = 1);
/// Any number >= 2 of plateaus in the order of y, joined by straight ramps.
Target plateaus_target(const std::vector<Plateau>& levels);
/// A-B-A (gi_outer 1, gi_inner 0) or B-A-B: outer GI up to `in_from`, inner GI from `in_to` to `out_from`,
/// outer GI again from `out_to` on, straight ramps between [m].
Target aba_target(double gi_outer, double gi_inner, double in_from, double in_to, double out_from,
                  double out_to);
/// CSV with the columns y [m, or with unit named in the header as y_mm / y_um / y_m], gi and, where wanted,
/// weight (>= 0; 0 = don't care). A weight holds from its y to the next line's, the first also below and the
/// last also beyond: a step function, because a measured line says where it may be trusted, not how trust
/// fades. Weights become zones, neighbours of one weight a single one. Throws std::runtime_error naming file,
/// line and rule of every fault.
Target table_target(const std::string& csv_file);
/// CSV with the columns x and y [m, or with the unit in the header as x_mm, y_um ...], gi and, where wanted,
/// weight, on a full rectangular grid, lines in any order: g(x, y), bilinear between the points and constant
/// beyond. A weight holds from its point to the next in x and in y; the first also before, the last also
/// beyond. The mean over x is taken over the whole grid until `over_x` says another range. Throws as
/// table_target does.
Target field_target(const std::string& csv_file);
std::vector<std::string> problems(const Target& target);  ///< all at once; empty when sound

}  // namespace gradwright
