#include "reports/html_report.h"

#include <stdexcept>
#include <string_view>

#include "reports/partition_drawing.h"
#include "reports/safe_write.h"

// Files of reports/page and reports/vendor, linked in as they are (page_files.S).
extern "C" {
extern const char gradwright_page_css[], gradwright_page_css_end[];
extern const char gradwright_page_js[], gradwright_page_js_end[];
extern const char gradwright_grains_js[], gradwright_grains_js_end[];
extern const char gradwright_scene_js[], gradwright_scene_js_end[];
extern const char gradwright_three_js[], gradwright_three_js_end[];
extern const char gradwright_d3_js[], gradwright_d3_js_end[];
extern const char gradwright_plot_js[], gradwright_plot_js_end[];
}

namespace gradwright {
namespace {

std::string_view between(const char* begin, const char* end) {
    return {begin, static_cast<std::size_t>(end - begin)};
}

/// JSON inside <script>: "</" and "<!--" would end or change the block, so every "<" is written as an escape.
/// U+2028/9 are legal.
std::string json_block(const nlohmann::json& data) {
    const std::string text = data.dump(-1, ' ', false, nlohmann::json::error_handler_t::replace);
    std::string out;
    out.reserve(text.size());
    for (char c : text) {
        if (c == '<')
            out += "\\u003c";
        else
            out += c;
    }
    return out;
}

}  // namespace

std::string page_html(const PageParts& parts, const nlohmann::json& data,
                      const std::vector<std::string_view>& scripts) {
    std::string html;
    html += "<!doctype html>\n<html lang=\"en-GB\">\n<head>\n<meta charset=\"utf-8\">\n";
    html += "<meta name=\"viewport\" content=\"width=device-width, initial-scale=1\">\n";
    // The page may not load anything from anywhere, whatever its data say.
    html +=
        "<meta http-equiv=\"Content-Security-Policy\" content=\"default-src 'none'; script-src "
        "'unsafe-inline'; style-src "
        "'unsafe-inline'; img-src data: blob:\">\n";
    html += "<link rel=\"icon\" href=\"data:,\">\n";
    html += "<title>" + escaped(parts.title) + " | Gradwright</title>\n<style>\n";
    html += between(gradwright_page_css, gradwright_page_css_end);
    html += "</style>\n</head>\n<body>\n<a class=\"skip\" href=\"#" + parts.first_figure +
            "\">Skip to the figures</a>\n";
    html += "<header class=\"" + escaped(parts.state) + "\">\n<p class=\"maker\">" + escaped(parts.maker) +
            "</p>\n<h1>" + escaped(parts.heading) + "</h1>\n";
    html += "<p class=\"target\">" + escaped(parts.subheading) + "</p>\n";
    html += "<div class=\"verdict\" id=\"verdict\"><p class=\"headline\">" + escaped(parts.headline) +
            "</p><p>" + escaped(parts.words) + "</p></div>\n</header>\n";
    html +=
        "<main id=\"page\"></main>\n<noscript><p>The figures are drawn by the page's own script; switch "
        "scripts on to see them.</p>"
        "</noscript>\n";
    html += "<script type=\"application/json\" id=\"data\">" + json_block(data) + "</script>\n";
    const auto script = [&](std::string_view text) {
        html += "<script>\n";
        html += text;
        html += "\n</script>\n";
    };
    script(between(gradwright_d3_js, gradwright_d3_js_end));
    script(between(gradwright_plot_js, gradwright_plot_js_end));
    for (const std::string_view text : scripts) script(text);
    html += "</body>\n</html>\n";
    return html;
}

std::string report_html(const nlohmann::json& data) {
    if (!data.is_object() || data.value("format", "") != "gradwright-report-1")
        throw std::invalid_argument(
            "not report data of this program: the field `format` must be \"gradwright-report-1\"");
    const auto& words = data.at("words");
    PageParts parts;
    parts.heading = data.at("result").value("study", "");
    parts.headline = words.value("headline", "");
    parts.title = parts.heading + ": " + parts.headline;
    parts.maker = "Gradwright design report";
    parts.subheading = data.at("result").value("target", "");
    parts.words = words.value("verdict", "");
    parts.state = words.value("state", "failed");
    parts.first_figure = "figures";
    std::vector<std::string_view> scripts;
    // half a megabyte: only where there are grains to draw
    if (!data.value("pictures", nlohmann::json::array()).empty())
        scripts.push_back(between(gradwright_three_js, gradwright_three_js_end));
    scripts.push_back(between(gradwright_grains_js, gradwright_grains_js_end));
    scripts.push_back(between(gradwright_scene_js, gradwright_scene_js_end));
    scripts.push_back(between(gradwright_page_js, gradwright_page_js_end));
    return page_html(parts, data, scripts);
}

void write_report(const nlohmann::json& data, const std::string& html_path) {
    write_file(html_path, report_html(data));
}

}  // namespace gradwright
