// Numbers with units, and the nearest valid name: what the study file needs to be strict and helpful at once.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string_view>

#include "optimise/joined.h"
#include "optimise/study_file.h"

namespace gradwright {
namespace {

struct Unit {
    std::string_view dimension, name;
    double si;    ///< one such unit in SI
    bool spoken;  ///< named when an error lists the units; the rest are accepted spellings
};

constexpr double kDegree = std::numbers::pi / 180;

// The first spoken unit of a dimension opens the example in its error message.
constexpr std::array kUnits = {
    Unit{"length", "um", 1e-6, true},
    Unit{"length", "mm", 1e-3, true},
    Unit{"length", "m", 1, true},
    Unit{"length", "cm", 1e-2, false},
    Unit{"length", "nm", 1e-9, false},
    Unit{"length", "\u00b5m", 1e-6, false},  // micro sign
    Unit{"length", "\u03bcm", 1e-6, false},  // Greek mu
    Unit{"speed", "mm/s", 1e-3, true},
    Unit{"speed", "m/s", 1, true},
    Unit{"speed", "um/s", 1e-6, false},
    Unit{"angle", "deg", kDegree, true},
    Unit{"angle", "rad", 1, true},
    Unit{"angle", "\u00b0", kDegree, false},
    Unit{"work_of_adhesion", "J/m2", 1, true},
    Unit{"work_of_adhesion", "mJ/m2", 1e-3, true},
    Unit{"work_of_adhesion", "J/m^2", 1, false},
    Unit{"work_of_adhesion", "mJ/m^2", 1e-3, false},
    Unit{"work_of_adhesion", "J/m\u00b2", 1, false},
    Unit{"work_of_adhesion", "N/m", 1, false},
    Unit{"pressure", "GPa", 1e9, true},
    Unit{"pressure", "MPa", 1e6, true},
    Unit{"pressure", "kPa", 1e3, false},
    Unit{"pressure", "Pa", 1, true},
    Unit{"density", "kg/m3", 1, true},
    Unit{"density", "g/cm3", 1e3, true},
    Unit{"density", "kg/m^3", 1, false},
    Unit{"density", "g/cm^3", 1e3, false},
    Unit{"acceleration", "m/s2", 1, true},
    Unit{"acceleration", "m/s^2", 1, false},
};

std::vector<std::string> units_of(std::string_view dimension) {
    std::vector<std::string> names;
    for (const Unit& unit : kUnits)
        if (unit.dimension == dimension && unit.spoken) names.emplace_back(unit.name);
    return names;
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.front()))) text.remove_prefix(1);
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back()))) text.remove_suffix(1);
    return text;
}

std::string spoken(const std::string& dimension) {
    return dimension == "work_of_adhesion" ? "energy per area" : dimension;
}

std::string lower(std::string text) {
    for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
    return text;
}

/// Levenshtein distance with a transposition of neighbours counted once.
std::size_t edit_distance(const std::string& a, const std::string& b) {
    std::vector<std::vector<std::size_t>> d(a.size() + 1, std::vector<std::size_t>(b.size() + 1));
    for (std::size_t i = 0; i <= a.size(); ++i) d[i][0] = i;
    for (std::size_t j = 0; j <= b.size(); ++j) d[0][j] = j;
    for (std::size_t i = 1; i <= a.size(); ++i)
        for (std::size_t j = 1; j <= b.size(); ++j) {
            d[i][j] = std::min(
                {d[i - 1][j] + 1, d[i][j - 1] + 1, d[i - 1][j - 1] + (a[i - 1] == b[j - 1] ? 0 : 1)});
            if (i > 1 && j > 1 && a[i - 1] == b[j - 2] && a[i - 2] == b[j - 1])
                d[i][j] = std::min(d[i][j], d[i - 2][j - 2] + 1);
        }
    return d[a.size()][b.size()];
}

}  // namespace

double parse_quantity(const std::string& text, const std::string& dimension) {
    const std::string list = joined(units_of(dimension));
    if (list.empty()) throw std::invalid_argument(fmt::format("unknown dimension \"{}\"", dimension));
    std::string_view rest = trimmed(text);
    // from_chars takes no plus sign.
    if (rest.size() > 1 && rest[0] == '+' && rest[1] != '-' && rest[1] != '+') rest.remove_prefix(1);
    double number = 0;
    const auto [end, code] = std::from_chars(rest.data(), rest.data() + rest.size(), number);
    if (code == std::errc::result_out_of_range)
        throw std::invalid_argument("the number is too large or too small to be held");
    if (code != std::errc{}) throw std::invalid_argument("must be a number with a unit");
    if (!std::isfinite(number)) throw std::invalid_argument("must be a finite number");
    const std::string_view name = trimmed(rest.substr(static_cast<std::size_t>(end - rest.data())));
    if (name.empty()) throw std::invalid_argument(fmt::format("the unit is missing ({})", list));
    for (const Unit& unit : kUnits)
        if (unit.dimension == dimension && unit.name == name) {
            const double si = number * unit.si;
            // 40 * 1e-6 and 40 / 1e6 differ in the last bit; the nearest double of the decimal number is the
            // one a reader who writes 40e-6 in code gets, so divide where the unit is a whole fraction of SI.
            const double inverse = std::round(1 / unit.si);
            const bool whole_fraction = unit.si < 1 && unit.dimension != "angle";
            return whole_fraction ? number / inverse : si;
        }
    throw std::invalid_argument(fmt::format("\"{}\" is no unit of {} ({})", name, spoken(dimension), list));
}

std::string format_quantity(double si, const std::string& dimension) {
    const auto number = [](double value) { return fmt::format("{:.6g}", value == 0 ? 0.0 : value); };
    const double size = std::abs(si);
    if (dimension == "length") {
        if (size >= 1) return number(si) + " m";
        if (size >= 0.2e-3 || size == 0) return number(si * 1e3) + " mm";
        return number(si * 1e6) + " um";
    }
    if (dimension == "speed") return size >= 1 ? number(si) + " m/s" : number(si * 1e3) + " mm/s";
    if (dimension == "angle") return number(si / kDegree) + " deg";
    if (dimension == "work_of_adhesion") return number(si) + " J/m2";
    if (dimension == "pressure") {
        if (size >= 1e9) return number(si * 1e-9) + " GPa";
        return size >= 1e6 ? number(si * 1e-6) + " MPa" : number(si) + " Pa";
    }
    if (dimension == "density") return number(si) + " kg/m3";
    if (dimension == "acceleration") return number(si) + " m/s2";
    return number(si);
}

std::string nearest_name(const std::string& word, const std::vector<std::string>& valid) {
    std::string best;
    std::size_t best_distance =
        std::max<std::size_t>(2, word.size() / 3) + 1;  // farther than this is no hint
    for (const std::string& name : valid) {
        const std::size_t distance = edit_distance(lower(word), lower(name));
        // Half a name changed is another name: "x" is not meant by "use".
        if (distance < best_distance && 2 * distance < std::max(word.size(), name.size()) + 1) {
            best = name;
            best_distance = distance;
        }
    }
    if (!best.empty()) return best;
    // A shortened or lengthened name: "friction" for "static_friction".
    for (const std::string& name : valid)
        if (word.size() >= 4 && (lower(name).find(lower(word)) != std::string::npos ||
                                 (name.size() >= 4 && lower(word).find(lower(name)) != std::string::npos)))
            return name;
    return {};
}

}  // namespace gradwright
