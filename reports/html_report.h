// report.html: one self-contained page that works offline. All figures are drawn in the page from one JSON
// block by Observable Plot (vendored, see vendor/); nothing is fetched.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

namespace gradwright {

/// The frame that every page of ours shares: header, one JSON block, D3 and Plot, then its own script.
struct PageParts {
    std::string title, maker, heading, subheading, headline, words;
    std::string state;         ///< "met" | "not_met" | "undecided" | "failed": colour of the headline
    std::string first_figure;  ///< id to which "skip to the figures" leads
};
/// `scripts`: texts put into the page after the libraries, in order.
std::string page_html(const PageParts& parts, const nlohmann::json& data,
                      const std::vector<std::string_view>& scripts);

/// The page for an object made by report_data(). Throws std::invalid_argument when it is not one.
std::string report_html(const nlohmann::json& report_data);
/// The page into a file, aside and renamed. Throws std::runtime_error naming the path and the system's
/// reason.
void write_report(const nlohmann::json& report_data, const std::string& html_path);

}  // namespace gradwright
