#include "reports/field_json.h"

#include <fmt/format.h>

#include <cmath>
#include <limits>

#include "reports/json_support.h"

namespace gradwright {
namespace {

using nlohmann::json;

constexpr double kUndefined = std::numeric_limits<double>::quiet_NaN();

/// Cells of a field, column after column, as rows of y; `shown(cell)` false leaves null.
template <class Shown>
json rows(const GradationField& field, const std::vector<double>& cells, Shown&& shown) {
    json result = json::array();
    const std::size_t bins = field.y_m.size();
    for (std::size_t bin = 0; bin < bins; ++bin) {
        json row = json::array();
        for (std::size_t column = 0; column < field.x_m.size(); ++column) {
            const std::size_t cell = column * bins + bin;
            row.push_back(number(cell < cells.size() && shown(cell) ? cells[cell] : kUndefined));
        }
        result.push_back(row);
    }
    return result;
}

json rows(const GradationField& field, const std::vector<double>& cells) {
    return rows(field, cells, [](std::size_t) { return true; });
}

/// What is the same for a result and for an evaluation: axes, target, weight, bands of what was `found`.
json common(const GradationField& found, const std::vector<double>& target,
            const std::vector<double>& weight) {
    const GradationProfile& cells = found.cells;
    const Band band = simultaneous_band(cells.gi, cells.standard_error, cells.degrees, weight);
    const auto counts = [&](std::size_t cell) { return cell < weight.size() && weight[cell] > 0; };
    return {{"x_m", numbers(found.x_m)},
            {"y_m", numbers(found.y_m)},
            {"target", rows(found, target, counts)},
            {"standard_error", rows(found, cells.standard_error, counts)},
            {"band_low", rows(found, band.low, counts)},
            {"band_high", rows(found, band.high, counts)},
            {"weight", rows(found, weight)},
            {"band", "simultaneous 95 % over the cells"},
            {"order", "[y][x]"}};
}

}  // namespace

json field_json(const StudyResult& result) {
    if (result.field_target.empty() || result.predicted.field.x_m.empty()) return nullptr;
    const bool proved = !result.confirmed_field.x_m.empty();
    const GradationField& predicted = result.predicted.field;
    const GradationField& found = proved ? result.confirmed_field : predicted;
    const std::vector<double>& weight = result.field_weight;
    const auto counts = [&](std::size_t cell) { return cell < weight.size() && weight[cell] > 0; };
    const auto left = [&](std::size_t cell) { return !counts(cell); };
    const std::vector<double> none(result.field_target.size(), kUndefined);
    const std::vector<double>& confirmed = proved ? found.cells.gi : none;
    json field = common(found, result.field_target, weight);
    field["predicted"] = rows(predicted, predicted.cells.gi);
    field["predicted_standard_error"] = rows(predicted, predicted.cells.standard_error);
    field["confirmed"] = rows(found, confirmed, counts);
    field["left_out"] = {{"target", rows(found, result.field_target, left)},
                         {"confirmed", rows(found, confirmed, left)}};
    field["of"] = proved ? "confirmed" : "predicted";
    return field;
}

json field_json(const Evaluation& evaluation) {
    if (evaluation.field_target.empty() || evaluation.field.x_m.empty()) return nullptr;
    json field = common(evaluation.field, evaluation.field_target, evaluation.field_weight);
    field["gi"] = rows(evaluation.field, evaluation.field.cells.gi);
    return field;
}

std::string field_table(const GradationField& found, const std::vector<double>& target, const char* name) {
    const std::size_t bins = found.y_m.size();
    const auto gi = [](const std::vector<double>& cells, std::size_t cell) {
        return cell < cells.size() && std::isfinite(cells[cell]) ? fmt::format("{:.3f}", cells[cell]) : "-";
    };
    std::string text = fmt::format("    y mm   target / {} at x mm\n         ", name);
    for (const double x : found.x_m) text += fmt::format("{:>16.2f}", x * 1e3);
    text += "\n";
    for (std::size_t bin = 0; bin < bins; ++bin) {
        text += fmt::format("  {:6.2f} ", found.y_m[bin] * 1e3);
        for (std::size_t column = 0; column < found.x_m.size(); ++column) {
            const std::size_t cell = column * bins + bin;
            text += fmt::format("{:>16}", gi(target, cell) + " / " + gi(found.cells.gi, cell));
        }
        text += "\n";
    }
    return text;
}

}  // namespace gradwright
