// Finished designs side by side, from the report_data.json of each: as JSON, as text for a terminal and as a
// page.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

namespace gradwright {

/// One finished design: its folder as the user named it, and the object of report_data().
struct FinishedDesign {
    std::string folder;
    nlohmann::json data;
};

/// {format, designs[{name, folder, study, target, verdict, misfit, x_drift, coverage, ..., design, profile,
/// plan}], same_target, differences[{key, values}], provenance}: lengths in m, undefined null. `differences`:
/// the inputs whose values are not the same in all; null where a design has no such input. Throws
/// std::runtime_error naming the folder when data are not a report's.
nlohmann::json designs_json(const std::vector<FinishedDesign>& designs);
/// Table of the designs and of the inputs that differ. Ends with a newline.
std::string designs_text(const nlohmann::json& designs);
/// One self-contained page for the object of designs_json().
std::string designs_html(const nlohmann::json& designs);

}  // namespace gradwright
