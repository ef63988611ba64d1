#include "optimise/bounded_search.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <limits>
#include <nlopt.hpp>
#include <stdexcept>

namespace gradwright {
namespace {

struct Call {
    const std::function<double(const std::vector<double>&)>* objective = nullptr;
    const BoundedSearch* search = nullptr;
    std::vector<int> free;
    nlopt::opt* native = nullptr;
    BoundedSearchResult* result = nullptr;
    std::exception_ptr thrown;
    bool stopped = false, spent = false;
    double worst = 0;

    /// Some methods call again before they look whether they were told to stop.
    bool ended() {
        if (thrown || stopped || spent) return true;
        stopped = search->stop && search->stop();
        spent = result->evaluations >= search->budget;
        return stopped || spent;
    }
    double operator()(const std::vector<double>& x) {
        if (ended()) {
            native->force_stop();
            return worst;
        }
        try {
            std::vector<double> point = search->start;
            for (std::size_t i = 0; i < free.size(); ++i)
                point[free[i]] = std::clamp(x[i], search->low[free[i]], search->high[free[i]]);
            const double value = (*objective)(point);
            ++result->evaluations;
            if (!std::isfinite(value)) return worst += 1;
            worst = result->evaluations == 1 ? value : std::max(worst, value);
            if (value < result->value) {
                result->value = value;
                result->best = point;
            }
            return value;
        } catch (...) {
            thrown = std::current_exception();
            native->force_stop();
            return worst;
        }
    }
};

double call_back(const std::vector<double>& x, std::vector<double>&, void* data) {
    return (*static_cast<Call*>(data))(x);
}

struct NativeMethod {
    nlopt::algorithm algorithm;
    const char* name;
};

NativeMethod native_method(SearchMethod method, std::size_t variables) {
    switch (method) {
        case SearchMethod::bobyqa:
            if (variables > 1) return {nlopt::LN_BOBYQA, "LN_BOBYQA"};
            break;
        case SearchMethod::cobyla:
            return {nlopt::LN_COBYLA, "LN_COBYLA"};
        case SearchMethod::crs:
            return {nlopt::GN_CRS2_LM, "GN_CRS2_LM"};
        case SearchMethod::isres:
            return {nlopt::GN_ISRES, "GN_ISRES"};
        case SearchMethod::direct:
            return {nlopt::GN_DIRECT_L, "GN_DIRECT_L"};
        case SearchMethod::sbplx:
            break;
    }
    return {nlopt::LN_SBPLX, "LN_SBPLX"};
}

/// A quarter (crs) or a sixth (isres) of the budget in the first generation, within what the method can work
/// with: crs needs a simplex, isres a parent for each seven.
int population(SearchMethod method, int variables, int budget) {
    const bool crs = method == SearchMethod::crs;
    const int least = crs ? variables + 2 : 14, most = (crs ? 10 : 20) * (variables + 1);
    return std::clamp(budget / (crs ? 4 : 6), least, most);
}

}  // namespace

const char* to_string(SearchMethod method) {
    switch (method) {
        case SearchMethod::bobyqa:
            return "bobyqa";
        case SearchMethod::cobyla:
            return "cobyla";
        case SearchMethod::sbplx:
            return "sbplx";
        case SearchMethod::crs:
            return "crs";
        case SearchMethod::isres:
            return "isres";
        case SearchMethod::direct:
            return "direct";
    }
    return "unknown";
}

std::optional<SearchMethod> search_method(const std::string& name) {
    for (const SearchMethod method : kSearchMethods)
        if (name == to_string(method)) return method;
    return std::nullopt;
}

BoundedSearchResult minimise(const std::function<double(const std::vector<double>&)>& objective,
                             const BoundedSearch& search) {
    BoundedSearchResult result;
    result.value = std::numeric_limits<double>::infinity();
    Call call;
    call.objective = &objective;
    call.search = &search;
    call.result = &result;
    std::vector<double> low, high, start, step;
    for (std::size_t i = 0; i < search.start.size(); ++i) {
        const double room = search.high[i] - search.low[i];
        if (!(room > 0)) continue;
        call.free.push_back(int(i));
        low.push_back(search.low[i]);
        high.push_back(search.high[i]);
        start.push_back(std::clamp(search.start[i], search.low[i], search.high[i]));
        step.push_back(std::min(search.step[i], 0.25 * room));
    }
    if (call.free.empty()) throw std::invalid_argument("search: no variable is free");
    const auto [algorithm, name] = native_method(search.method, call.free.size());
    nlopt::opt native(algorithm, unsigned(call.free.size()));
    call.native = &native;
    native.set_min_objective(call_back, &call);
    native.set_lower_bounds(low);
    native.set_upper_bounds(high);
    native.set_initial_step(step);
    native.set_xtol_abs(search.x_tolerance);
    if (search.f_tolerance > 0) native.set_ftol_abs(search.f_tolerance);
    if (algorithm == nlopt::GN_CRS2_LM || algorithm == nlopt::GN_ISRES) {
        native.set_population(unsigned(population(search.method, int(call.free.size()), search.budget)));
        nlopt::srand(static_cast<unsigned long>(search.seed));
    }
    if (algorithm == nlopt::GN_DIRECT_L) call(start);
    native.set_maxeval(std::max(1, search.budget - result.evaluations));
    std::string code = "FORCED_STOP";
    if (!call.thrown && !call.stopped && result.evaluations < search.budget) {
        double value = 0;
        try {
            const nlopt::result end = native.optimize(start, value);
            code = nlopt_result_to_string(static_cast<nlopt_result>(end));
            result.termination = end == nlopt::MAXEVAL_REACHED ? "budget" : "converged";
        } catch (const nlopt::roundoff_limited&) {
            result.termination = "converged";
            code = "ROUNDOFF_LIMITED";
        } catch (const nlopt::forced_stop&) {
            result.termination = "budget";
        } catch (const std::runtime_error&) {
            result.termination = "failed";
            code = "FAILURE";
        }
    } else {
        result.termination = "budget";
        code = "MAXEVAL_REACHED";
    }
    result.native = std::string(name) + ": " + code;
    if (call.thrown) std::rethrow_exception(call.thrown);
    if (call.stopped) result.termination = "interrupted";
    if (result.best.empty()) result.best = search.start;
    return result;
}

}  // namespace gradwright
