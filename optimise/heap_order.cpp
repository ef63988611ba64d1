#include "optimise/heap_order.h"

#include <ceres/ceres.h>
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <stdexcept>

namespace gradwright {
namespace {

constexpr int kOriginSteps = 40;  // of xi in the rms of an order
constexpr int kParameters = 4;    // of the law
constexpr int kModes = 3;         // of a difference of two W that count

/// W(xi) at xi = 1/40 .. 39/40 of the grains with deposit in [low, high) of the platform; empty without
/// grains.
std::vector<double> origin_distribution(const Layer& layer, double low, double high) {
    std::vector<double> within(kOriginSteps + 1, 0.0);
    double total = 0;
    for (std::size_t i = 0; i < layer.size(); ++i) {
        const double at = layer.deposit_x[i] / layer.platform_length;
        if (at < low || at >= high) continue;
        const double xi = std::clamp(layer.origin_x[i] / layer.dispenser_length, 0.0, 1.0);
        within[std::min(kOriginSteps, int(std::ceil(xi * kOriginSteps)))] += layer.volume[i];
        total += layer.volume[i];
    }
    if (!(total > 0)) return {};
    std::vector<double> share(kOriginSteps - 1);
    double sum = within[0];
    for (int k = 1; k < kOriginSteps; ++k) {
        sum += within[k];
        share[k - 1] = sum / total;
    }
    return share;
}

double rms(const std::vector<double>& values) {
    double sum = 0;
    for (const double value : values) sum += value * value;
    return std::sqrt(sum / double(values.size()));
}

/// p: the two amplitudes of cosine and sine, logarithms of memory and turn.
struct OrderResidual {
    double turnovers, order;
    template <class T>
    bool operator()(const T* p, T* residual) const {
        using std::cos;
        using std::exp;
        using std::sin;
        const T angle = 2 * std::numbers::pi * turnovers * exp(-p[3]);
        residual[0] = exp(-turnovers * exp(-p[2])) * (p[0] * cos(angle) + p[1] * sin(angle)) - order;
        return true;
    }
};

struct Fit {
    double p[kParameters] = {0, 0, 0, 0};
    double cost = std::numeric_limits<double>::infinity();
    bool usable = false;
};

Fit fit_from(std::span<const double> turnovers, std::span<const double> order, double memory, double turn) {
    Fit fit;
    fit.p[2] = std::log(memory);
    fit.p[3] = std::log(turn);
    ceres::Problem problem;
    for (std::size_t k = 0; k < turnovers.size(); ++k)
        problem.AddResidualBlock(new ceres::AutoDiffCostFunction<OrderResidual, 1, kParameters>(
                                     new OrderResidual{turnovers[k], order[k]}),
                                 nullptr, fit.p);
    // A turn shorter than the way between two strips would fit anything. An order at N = 0 is that of a heap
    // laid without any mixing, |W - xi| <= 1; the mode of such a step is below 1.
    const double low[kParameters] = {-2, -2, std::log(1.0), std::log(8.0)},
                 high[kParameters] = {2, 2, std::log(200.0), std::log(100.0)};
    for (int i = 0; i < kParameters; ++i) {
        problem.SetParameterLowerBound(fit.p, i, low[i]);
        problem.SetParameterUpperBound(fit.p, i, high[i]);
    }
    ceres::Solver::Options options;
    options.linear_solver_type = ceres::DENSE_QR;
    options.max_num_iterations = 200;
    options.function_tolerance = 1e-10;
    options.logging_type = ceres::SILENT;
    options.num_threads = 1;
    ceres::Solver::Summary summary;
    ceres::Solve(options, &problem, &summary);
    fit.usable = summary.IsSolutionUsable();
    fit.cost = summary.final_cost;
    return fit;
}

/// The best of several starts: the cost has a valley for every turn that fits.
Fit best_fit(std::span<const double> turnovers, std::span<const double> order) {
    Fit best;
    for (const double turn : {10.0, 14.0, 20.0, 40.0})
        for (const double memory : {4.0, 12.0, 40.0}) {
            const Fit fit = fit_from(turnovers, order, memory, turn);
            if (fit.usable && fit.cost < best.cost) best = fit;
        }
    return best;
}

OrderLaw law_of(const Fit& fit, int strips) {
    OrderLaw law;
    law.amplitude = std::hypot(fit.p[0], fit.p[1]);
    law.phase = std::atan2(-fit.p[1], fit.p[0]);
    law.memory = std::exp(fit.p[2]);
    law.turn = std::exp(fit.p[3]);
    law.fitted = fit.usable;
    law.strips = strips;
    return law;
}

}  // namespace

double heap_turnovers(const Scene& scene) {
    return std::sqrt(scene.dispenser_length / scene.dose_height);
}

HeapOrder heap_order(const Layer& layer, const Scene& scene, double low, double high) {
    HeapOrder order;
    order.dispenser_length = layer.dispenser_length;
    order.dosage_factor =
        scene.dose_height * scene.dispenser_length / (scene.layer_thickness * scene.platform_length);
    order.turnovers = heap_turnovers(scene);
    order.seed = layer.packing_seed;
    order.capture_fraction = layer.capture_fraction();
    order.coverage =
        coverage(layer, {low * layer.platform_length, high * layer.platform_length, 0, layer.width});

    const double third = (high - low) / 3;
    std::vector<double> whole = origin_distribution(layer, low, high);
    const std::vector<double> first = origin_distribution(layer, low, low + third);
    std::vector<double> last = origin_distribution(layer, high - third, high);
    if (whole.empty() || first.empty() || last.empty())
        throw std::invalid_argument(
            fmt::format("nothing was laid in a third of the footprint of the {:.3g} mm strip",
                        1e3 * layer.dispenser_length));
    for (std::size_t k = 0; k < whole.size(); ++k) {
        whole[k] -= double(k + 1) / kOriginSteps;
        last[k] -= first[k];
    }
    order.share = whole;
    for (std::size_t k = 0; k < whole.size(); ++k)
        order.profile += std::numbers::sqrt2 / kOriginSteps * whole[k] *
                         std::sin(std::numbers::pi * double(k + 1) / kOriginSteps);
    for (std::size_t k = 0; k < whole.size(); ++k)
        whole[k] -=
            order.profile * std::numbers::sqrt2 * std::sin(std::numbers::pi * double(k + 1) / kOriginSteps);
    order.profile_rest = rms(whole);
    order.drift = rms(last);
    order.share_drift = last;

    double volume = 0, mean = 0, square = 0;
    for (std::size_t i = 0; i < layer.size(); ++i) {
        const double way = layer.deposit_y[i] - layer.origin_y[i];
        volume += layer.volume[i];
        mean += layer.volume[i] * way;
        square += layer.volume[i] * way * way;
    }
    mean /= volume;
    const double d50 = scene.powder[0].size.d50;  // a strip holds powder A alone
    order.lateral = std::max(0.0, square / volume - mean * mean) / (d50 * d50 * order.turnovers);
    return order;
}

double OrderLaw::envelope(double turnovers) const {
    return amplitude * std::exp(-turnovers / memory);
}

double OrderLaw::at(double turnovers) const {
    return envelope(turnovers) * std::cos(2 * std::numbers::pi * turnovers / turn + phase);
}

OrderLaw fit_order_law(std::span<const double> turnovers, std::span<const double> order) {
    const std::size_t strips = turnovers.size();
    OrderLaw law;
    law.strips = int(strips);
    if (law.strips <= kParameters) return law;
    law = law_of(best_fit(turnovers, order), law.strips);
    double sum = 0;
    for (std::size_t k = 0; k < strips; ++k) sum += std::pow(order[k] - law.at(turnovers[k]), 2);
    law.collapse_error = std::sqrt(sum / double(law.strips - kParameters));
    if (law.strips > kParameters + 1) {
        const std::size_t longest =
            std::size_t(std::max_element(turnovers.begin(), turnovers.end()) - turnovers.begin());
        std::vector<double> fewer(turnovers.begin(), turnovers.end()), orders(order.begin(), order.end());
        fewer.erase(fewer.begin() + long(longest));
        orders.erase(orders.begin() + long(longest));
        const OrderLaw shorter = law_of(best_fit(fewer, orders), law.strips - 1);
        law.longest_miss = shorter.at(turnovers[longest]) - order[longest];
        law.longest_envelope = shorter.envelope(turnovers[longest]);
    }
    return law;
}

void carry_extrapolation(const ScaledHeap& heap, Evaluation& evaluation) {
    // share of the dispenser's length on A's side of every bin's middle: where the partition stands in units
    // of xi
    constexpr int kAlong = 400;
    const PartitionCurve& partition = evaluation.design.partition;
    std::vector<double> shape;
    for (const double y : evaluation.profile.y_m) {
        int on_a = 0;
        for (int i = 0; i < kAlong; ++i) on_a += partition.on_side_a((i + 0.5) / kAlong * heap.length, y);
        shape.push_back(std::numbers::sqrt2 * std::sin(std::numbers::pi * on_a / kAlong));
    }
    const auto widen = [&](std::vector<double>& error, double by) {
        for (std::size_t b = 0; b < error.size() && b < shape.size(); ++b)
            error[b] = std::hypot(error[b], by * shape[b]);
    };
    widen(evaluation.profile.standard_error, heap.profile_error);
    widen(evaluation.drift.standard_error, heap.drift_error);
    evaluation.profile.degrees = evaluation.drift.degrees = kModes;
    evaluation.one_error = true;
}

double common_factor(double degrees) {
    const double one = 1;
    return simultaneous_factor({&one, 1}, 0.95, degrees);
}

double ScaledHeap::doublings() const {
    return std::max(1.0, std::log2(length / longest));
}

void carry_errors(ScaledHeap& heap, double dosage_factor) {
    const auto own = [&](const HeapOrder& strip) {
        return std::fabs(strip.dosage_factor / dosage_factor - 1) < 1e-6;
    };
    const auto difference = [](const std::vector<double>& a, const std::vector<double>& b) {
        std::vector<double> d(a.size());
        for (std::size_t k = 0; k < d.size(); ++k) d[k] = a[k] - b[k];
        return rms(d);
    };
    std::vector<const HeapOrder*> lengths;
    for (const HeapOrder& strip : heap.strips)
        if (own(strip)) lengths.push_back(&strip);
    if (lengths.size() < 2) throw std::invalid_argument("two lengths at the design's dose are needed");
    std::sort(lengths.begin(), lengths.end(), [](const HeapOrder* a, const HeapOrder* b) {
        return a->dispenser_length < b->dispenser_length;
    });
    const HeapOrder &last = *lengths.back(), &before = *lengths[lengths.size() - 2];
    heap.longest = last.dispenser_length;
    // measured over some ratio of lengths: as of one doubling
    const double measured = std::sqrt(std::log2(last.dispenser_length / before.dispenser_length));
    heap.profile_step = difference(last.share, before.share) / measured;
    heap.drift_step = difference(last.share_drift, before.share_drift) / measured;
    heap.dose_step = 0;
    for (const HeapOrder& a : heap.strips)
        for (const HeapOrder& b : heap.strips)
            if (own(a) && !own(b) && std::fabs(a.dispenser_length / b.dispenser_length - 1) < 1e-6)
                heap.dose_step = std::max(heap.dose_step, difference(a.share, b.share));
    const double further = std::sqrt(heap.doublings());
    heap.profile_error = further * heap.profile_step;
    heap.drift_error = further * heap.drift_step;
    for (const HeapOrder& strip : heap.strips) heap.drift_error = std::max(heap.drift_error, strip.drift);
    heap.nearest = last;
}

}  // namespace gradwright
