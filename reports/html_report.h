// report.html: one self-contained page that works offline. All figures are drawn in the page from one JSON
// block by Observable Plot (vendored, see vendor/); nothing is fetched.
#pragma once
#include <nlohmann/json.hpp>
#include <string>

namespace gradwright {

/// The page for an object made by report_data(). Throws std::invalid_argument when it is not one.
std::string report_html(const nlohmann::json& report_data);
/// The page into a file, aside and renamed. Throws std::runtime_error naming the path and the system's
/// reason.
void write_report(const nlohmann::json& report_data, const std::string& html_path);

}  // namespace gradwright
