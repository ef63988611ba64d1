#include "optimise/sensitivity_indices.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "dem/random.h"

namespace gradwright {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr int kResamples = 400;

std::vector<int> shuffled(int n, Random& random) {
    std::vector<int> order(static_cast<std::size_t>(n));
    std::iota(order.begin(), order.end(), 0);
    for (int i = n - 1; i > 0; --i)
        std::swap(order[std::size_t(i)], order[random.below(std::uint64_t(i) + 1)]);
    return order;
}

/// f(A), f(B) and f(AB_i) of one row and one output.
struct Row {
    double a, b;
    std::vector<double> mixed;
};

/// S_i and S_Ti over these rows, `pick` saying which; outputs are centred first, which changes no index and
/// keeps the first order's products small.
struct Estimate {
    std::vector<double> first, total;
    double mean = 0, variance = 0;
};
Estimate estimate(const std::vector<Row>& rows, const std::vector<std::size_t>& pick, int inputs) {
    Estimate out;
    const double n = double(pick.size());
    for (const std::size_t r : pick) out.mean += (rows[r].a + rows[r].b) / (2 * n);
    for (const std::size_t r : pick)
        out.variance += (std::pow(rows[r].a - out.mean, 2) + std::pow(rows[r].b - out.mean, 2)) / (2 * n - 1);
    if (out.variance <= 1e-24 * out.mean * out.mean) out.variance = 0;  // round-off of a constant
    for (int i = 0; i < inputs; ++i) {
        double first = 0, total = 0;
        for (const std::size_t r : pick) {
            const double mixed = rows[r].mixed[std::size_t(i)];
            first += (rows[r].b - out.mean) * (mixed - rows[r].a) / n;
            total += std::pow(rows[r].a - mixed, 2) / (2 * n);
        }
        out.first.push_back(out.variance > 0 ? first / out.variance : 0);
        out.total.push_back(out.variance > 0 ? total / out.variance : 0);
    }
    return out;
}

double quantile(std::vector<double> values, double share) {
    std::sort(values.begin(), values.end());
    return values[std::size_t(std::lround(share * double(values.size() - 1)))];
}

double deviation(const std::vector<double>& values) {
    const double mean = std::accumulate(values.begin(), values.end(), 0.0) / double(values.size());
    double sum = 0;
    for (const double v : values) sum += (v - mean) * (v - mean);
    return std::sqrt(sum / double(values.size() - 1));
}

}  // namespace

MorrisScreening morris_screening(const UnitModel& model, int inputs, int trajectories, std::uint64_t seed,
                                 int levels) {
    Random random(seed);
    MorrisScreening out;
    const double delta = levels / (2.0 * (levels - 1));
    std::vector<std::vector<std::vector<double>>> effects;  // [input][output]
    for (int t = 0; t < trajectories; ++t) {
        std::vector<double> x;
        std::vector<int> sign;
        for (int i = 0; i < inputs; ++i) {
            // levels from which the step still ends in the cube, upwards; mirrored for a step downwards
            const double base = double(random.below(std::uint64_t(levels / 2))) / (levels - 1);
            sign.push_back(random.below(2) ? 1 : -1);
            x.push_back(sign.back() > 0 ? base : 1 - base);
        }
        const auto evaluate = [&] {
            ++out.evaluations;
            auto value = model(x);
            out.failed += !value;
            return value;
        };
        auto before = evaluate();
        for (const int i : shuffled(inputs, random)) {
            x[std::size_t(i)] += sign[std::size_t(i)] * delta;
            auto after = evaluate();
            if (before && after) {
                effects.resize(std::size_t(inputs));
                auto& of_input = effects[std::size_t(i)];
                of_input.resize(after->size());
                for (std::size_t o = 0; o < after->size(); ++o)
                    of_input[o].push_back(sign[std::size_t(i)] * ((*after)[o] - (*before)[o]) / delta);
            }
            before = std::move(after);
        }
    }
    effects.resize(std::size_t(inputs));
    std::size_t outputs = 0;
    for (const auto& of_input : effects) outputs = std::max(outputs, of_input.size());
    for (auto& of_input : effects) {
        of_input.resize(outputs);
        std::vector<MorrisEffect> row;
        for (const std::vector<double>& all : of_input) {
            MorrisEffect effect;
            effect.effects = int(all.size());
            std::vector<double> size;
            for (const double e : all) {
                effect.mean += e / double(all.size());
                effect.mean_absolute += std::fabs(e) / double(all.size());
                size.push_back(std::fabs(e));
            }
            if (all.empty()) effect.mean = effect.mean_absolute = kNan;
            effect.deviation = all.size() > 1 ? deviation(all) : kNan;
            effect.standard_error = all.size() > 1 ? deviation(size) / std::sqrt(double(all.size())) : kNan;
            row.push_back(effect);
        }
        out.effect.push_back(row);
    }
    return out;
}

SobolIndices sobol_indices(const UnitModel& model, int inputs, int n, std::uint64_t seed) {
    Random random(seed);
    SobolIndices out;
    std::vector<std::vector<Row>> rows;  // [output][row]
    const auto point = [&] {
        std::vector<double> x;
        for (int i = 0; i < inputs; ++i) x.push_back(random.uniform());
        return x;
    };
    const auto evaluate = [&](const std::vector<double>& x) {
        ++out.evaluations;
        auto value = model(x);
        out.failed += !value;
        return value;
    };
    for (int r = 0; r < n; ++r) {
        const std::vector<double> a = point(), b = point();
        const auto of_a = evaluate(a), of_b = evaluate(b);
        std::vector<std::vector<double>> mixed;
        bool complete = of_a && of_b;
        for (int i = 0; i < inputs && complete; ++i) {
            std::vector<double> x = a;
            x[std::size_t(i)] = b[std::size_t(i)];
            if (auto value = evaluate(x))
                mixed.push_back(std::move(*value));
            else
                complete = false;
        }
        if (!complete) continue;
        ++out.rows;
        rows.resize(of_a->size());
        for (std::size_t o = 0; o < rows.size(); ++o) {
            Row row{(*of_a)[o], (*of_b)[o], {}};
            for (const auto& value : mixed) row.mixed.push_back(value[o]);
            rows[o].push_back(std::move(row));
        }
    }
    out.index.resize(std::size_t(inputs));
    std::vector<std::size_t> pick(static_cast<std::size_t>(out.rows));
    std::iota(pick.begin(), pick.end(), std::size_t(0));
    for (const std::vector<Row>& of_output : rows) {
        const Estimate found = estimate(of_output, pick, inputs);
        out.mean.push_back(found.mean);
        out.variance.push_back(found.variance);
        const auto count = std::size_t(inputs);
        std::vector<std::vector<double>> first(count), total(count);
        for (int k = 0; k < kResamples; ++k) {
            std::vector<std::size_t> again(pick.size());
            for (std::size_t& r : again) r = random.below(pick.size());
            const Estimate other = estimate(of_output, again, inputs);
            for (std::size_t i = 0; i < std::size_t(inputs); ++i) {
                first[i].push_back(other.first[i]);
                total[i].push_back(other.total[i]);
            }
        }
        for (std::size_t i = 0; i < std::size_t(inputs); ++i)
            out.index[i].push_back({found.first[i], found.total[i], deviation(first[i]), deviation(total[i]),
                                    quantile(first[i], 0.025), quantile(first[i], 0.975),
                                    quantile(total[i], 0.025), quantile(total[i], 0.975)});
    }
    return out;
}

}  // namespace gradwright
