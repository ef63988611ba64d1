#include "reports/json_support.h"

#include <cmath>

namespace gradwright {

nlohmann::json number(double value) {
    return std::isfinite(value) ? nlohmann::json(value) : nlohmann::json(nullptr);
}

nlohmann::json numbers(std::span<const double> values) {
    auto array = nlohmann::json::array();
    for (double value : values) array.push_back(number(value));
    return array;
}

nlohmann::json plan_points(std::span<const PlanPoint> points) {
    auto array = nlohmann::json::array();
    for (const PlanPoint& point : points) array.push_back({number(point.x), number(point.y)});
    return array;
}

}  // namespace gradwright
