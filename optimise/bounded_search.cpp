#include "optimise/bounded_search.h"

#include <algorithm>
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
    bool stopped = false;

    double operator()(const std::vector<double>& x) {
        if (search->stop && search->stop()) {
            stopped = true;
            native->force_stop();
            return result->value;
        }
        try {
            std::vector<double> point = search->start;
            for (std::size_t i = 0; i < free.size(); ++i)
                point[free[i]] = std::clamp(x[i], search->low[free[i]], search->high[free[i]]);
            const double value = (*objective)(point);
            ++result->evaluations;
            if (value < result->value) {
                result->value = value;
                result->best = point;
            }
            return value;
        } catch (...) {
            thrown = std::current_exception();
            native->force_stop();
            return std::numeric_limits<double>::max();
        }
    }
};

double call_back(const std::vector<double>& x, std::vector<double>&, void* data) {
    return (*static_cast<Call*>(data))(x);
}

}  // namespace

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
    const bool bobyqa = search.method == SearchMethod::bobyqa && call.free.size() > 1;
    nlopt::opt native(bobyqa ? nlopt::LN_BOBYQA : nlopt::LN_SBPLX, unsigned(call.free.size()));
    call.native = &native;
    native.set_min_objective(call_back, &call);
    native.set_lower_bounds(low);
    native.set_upper_bounds(high);
    native.set_initial_step(step);
    native.set_xtol_abs(search.x_tolerance);
    if (search.f_tolerance > 0) native.set_ftol_abs(search.f_tolerance);
    native.set_maxeval(search.budget);
    result.native = bobyqa ? "LN_BOBYQA: " : "LN_SBPLX: ";
    double value = 0;
    try {
        const nlopt::result code = native.optimize(start, value);
        result.termination = code == nlopt::MAXEVAL_REACHED ? "budget" : "converged";
        result.native += code == nlopt::MAXEVAL_REACHED ? "MAXEVAL_REACHED"
                         : code == nlopt::XTOL_REACHED  ? "XTOL_REACHED"
                         : code == nlopt::FTOL_REACHED  ? "FTOL_REACHED"
                                                        : "SUCCESS";
    } catch (const nlopt::roundoff_limited&) {
        result.termination = "converged";
        result.native += "ROUNDOFF_LIMITED";
    } catch (const nlopt::forced_stop&) {
        result.termination = "interrupted";
        result.native += "FORCED_STOP";
    }
    if (call.thrown) std::rethrow_exception(call.thrown);
    if (call.stopped) result.termination = "interrupted";
    if (result.best.empty()) result.best = search.start;
    return result;
}

}  // namespace gradwright
