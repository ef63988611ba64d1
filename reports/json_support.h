// Numbers into JSON without ever writing NaN: whatever is not finite becomes null, the one spelling of
// "undefined" in our files.
#pragma once
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "dem/partition.h"

namespace gradwright {

/// The number, or null when it is NaN or infinite.
nlohmann::json number(double value);
/// Array of numbers, nulls where undefined.
nlohmann::json numbers(std::span<const double> values);
/// [[x, y], ...] in m.
nlohmann::json plan_points(std::span<const PlanPoint> points);

}  // namespace gradwright
