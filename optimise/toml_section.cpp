// One table of a study file: typed reading, each value judged where it is read.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "optimise/joined.h"
#include "optimise/toml_reader.h"

namespace gradwright {
namespace {

/// A sound value of the dimension to show in a mend.
std::string example(const std::string& dimension) {
    if (dimension == "length") return "\"3.2 mm\"";
    if (dimension == "speed") return "\"100 mm/s\"";
    if (dimension == "angle") return "\"5 deg\"";
    if (dimension == "work_of_adhesion") return "\"0.02 J/m2\"";
    if (dimension == "pressure") return "\"195 GPa\"";
    if (dimension == "density") return "\"8200 kg/m3\"";
    if (dimension == "acceleration") return "\"9.81 m/s2\"";
    return "0.5";
}

std::string quoted_list(const std::vector<std::string>& names) {
    std::vector<std::string> quoted;
    for (const std::string& name : names) quoted.push_back('"' + name + '"');
    return joined(quoted);
}

/// "did you mean "fused"?" or the list of what is valid.
std::string hint(const std::string& word, const std::vector<std::string>& valid) {
    const std::string nearest = nearest_name(word, valid);
    const std::string list = "valid: " + joined(valid);
    return nearest.empty() ? list : fmt::format("did you mean \"{}\"? ({})", nearest, list);
}

/// A sound value to show in a mend: the default where there is one (not NaN).
std::string sample_of(double fallback, const std::string& dimension, const Range& range) {
    if (std::isnan(fallback) || !range.holds(fallback)) return example(dimension);
    const std::string text = format_quantity(fallback, dimension);
    return dimension.empty() ? text : '"' + text + '"';
}

}  // namespace

Section Section::sub(const std::string& key) {
    known_.push_back(key);
    const toml::node* node = table_ ? table_->get(key) : nullptr;
    if (!node) return {reader_, nullptr, path(key), line_};
    const auto [file, line] = reader_.place(path(key), node);
    if (!node->is_table())
        reader_.add({file, line, path(key), node_text(*node), "must be a table",
                     table_ == &reader_.root() ? fmt::format("write its keys under [{}]", key)
                                               : fmt::format("write {} = {{ ... }}", key)});
    return {reader_, node->as_table(), path(key), line};
}

bool Section::has(const std::string& key) const {
    return table_ && table_->contains(key);
}

TomlReader::Found Section::find(const std::string& key) {
    known_.push_back(key);
    return reader_.locate(table_, path(key), key);
}

void Section::problem(const TomlReader::Found& found, const std::string& key, const std::string& rule,
                      const std::string& mend) {
    reader_.add({found.file, found.line, path(key), found.node ? node_text(*found.node) : "", rule, mend});
}

void Section::missing(const std::string& key, const std::string& mend) {
    reader_.add({reader_.file(), line_, path(key), "", "is required", mend});
}

void Section::refuse(const std::string& key, const std::string& rule, const std::string& mend) {
    if (!has(key)) return;
    const toml::node* node = table_->get(key);
    const auto [file, line] = reader_.place(path(key), node);
    reader_.add({file, line, path(key), node_text(*node), rule, mend});
}

void Section::finish() {
    if (!table_) return;
    std::vector<std::string> valid = known_;
    std::sort(valid.begin(), valid.end());
    valid.erase(std::unique(valid.begin(), valid.end()), valid.end());
    for (const auto& [key, node] : *table_) {
        const std::string name(key.str());
        if (std::find(valid.begin(), valid.end(), name) != valid.end()) continue;
        if (!reader_.sound({path(name)})) continue;  // refused already, with a better reason
        auto [file, line] = reader_.place(path(name), &node);
        if (line > 0) line = static_cast<int>(key.source().begin.line);
        reader_.add({file, line, path(name), node.is_table() ? "" : node_text(node), "is not a known key",
                     hint(name, valid)});
    }
}

std::optional<double> Section::value_of(const TomlReader::Found& found, const toml::node& node,
                                        const std::string& key, const std::string& dimension,
                                        const Range& range, const std::string& sample) {
    TomlReader::Found at = found;
    at.node = &node;
    double value = 0;
    if (dimension.empty()) {
        if (node.is_boolean() || !node.is_number()) {
            problem(at, key, "must be a plain number", "write it without quotes, such as " + sample);
            return {};
        }
        value = node.value<double>().value_or(std::numeric_limits<double>::quiet_NaN());
        if (!std::isfinite(value)) {
            problem(at, key, "must be a finite number", "such as " + sample);
            return {};
        }
    } else {
        if (node.is_number()) {
            problem(at, key, "has no unit", "write a string with its unit, such as " + sample);
            return {};
        }
        if (!node.is_string()) {
            problem(at, key, "must be a string with a unit", "such as " + sample);
            return {};
        }
        try {
            value = parse_quantity(node.as_string()->get(), dimension);
        } catch (const std::invalid_argument& error) {
            problem(at, key, error.what(), "such as " + sample);
            return {};
        }
    }
    if (!range.holds(value)) {
        problem(at, key, range.rule(dimension), "such as " + sample);
        return {};
    }
    return value;
}

double Section::quantity(const std::string& key, const std::string& dimension, const Default& fallback,
                         const Range& range) {
    const TomlReader::Found found = find(key);
    if (!found.node) {
        if (fallback.required) {
            missing(key, fallback.note);
        } else {
            const std::string text = format_quantity(fallback.value, dimension);
            reader_.record({path(key), text, unit_of(text), fallback.origin, fallback.note});
        }
        return fallback.value;
    }
    const double shown = fallback.required ? std::numeric_limits<double>::quiet_NaN() : fallback.value;
    const auto value =
        value_of(found, *found.node, key, dimension, range, sample_of(shown, dimension, range));
    const std::string text = input_text(*found.node);
    if (value) reader_.record({path(key), text, unit_of(text), found.origin, found.note});
    return value.value_or(fallback.value);
}

long Section::integer(const std::string& key, long fallback, const std::string& note, long low, long high) {
    const TomlReader::Found found = find(key);
    if (!found.node) {
        reader_.record({path(key), fmt::format("{}", fallback), "-", "default", note});
        return fallback;
    }
    if (!found.node->is_integer()) {
        problem(found, key, "must be a whole number", fmt::format("such as {}", fallback));
        return fallback;
    }
    const auto value = static_cast<long>(found.node->as_integer()->get());
    if (value < low || value > high) {
        problem(found, key,
                high == std::numeric_limits<long>::max() ? fmt::format("must be >= {}", low)
                                                         : fmt::format("must lie in [{}, {}]", low, high),
                fmt::format("such as {}", fallback));
        return fallback;
    }
    reader_.record({path(key), fmt::format("{}", value), "-", found.origin, found.note});
    return value;
}

bool Section::boolean(const std::string& key, bool fallback, const std::string& note) {
    const TomlReader::Found found = find(key);
    if (!found.node) {
        reader_.record({path(key), fallback ? "true" : "false", "", "default", note});
        return fallback;
    }
    if (!found.node->is_boolean()) {
        problem(found, key, "must be true or false", "without quotes");
        return fallback;
    }
    const bool value = found.node->as_boolean()->get();
    reader_.record({path(key), value ? "true" : "false", "", found.origin, found.note});
    return value;
}

std::string Section::text(const std::string& key, const std::string& fallback, const std::string& note) {
    const TomlReader::Found found = find(key);
    if (!found.node) {
        reader_.record({path(key), fallback, "", "default", note});
        return fallback;
    }
    if (!found.node->is_string()) {
        problem(found, key, "must be a string", "put it in quotes");
        return fallback;
    }
    const std::string value = found.node->as_string()->get();
    if (value.empty() || std::any_of(value.begin(), value.end(), [](char c) {
            return static_cast<unsigned char>(c) < 0x20 || c == 0x7f;
        })) {
        problem(found, key, "must be one line of text without control characters", "shorten or retype it");
        return fallback;
    }
    reader_.record({path(key), value, "", found.origin, found.note});
    return value;
}

std::string Section::choice(const std::string& key, const std::vector<std::string>& valid,
                            const std::string& fallback, const std::string& note) {
    const TomlReader::Found found = find(key);
    if (!found.node) {
        reader_.record({path(key), fallback, "", "default", note});
        return fallback;
    }
    const auto* value = found.node->as_string();
    if (!value || std::find(valid.begin(), valid.end(), value->get()) == valid.end()) {
        problem(found, key, "must be one of " + quoted_list(valid),
                value && !nearest_name(value->get(), valid).empty()
                    ? fmt::format("did you mean \"{}\"?", nearest_name(value->get(), valid))
                    : "choose one of them");
        return fallback;
    }
    reader_.record({path(key), value->get(), "", found.origin, found.note});
    return value->get();
}

std::pair<double, double> Section::pair(const std::string& key, const std::string& dimension,
                                        std::pair<double, double> fallback, const std::string& note,
                                        const Range& range) {
    const TomlReader::Found found = find(key);
    if (!found.node) {
        const std::string high = format_quantity(fallback.second, dimension);
        reader_.record({path(key), fmt::format("[{}, {}]", format_quantity(fallback.first, dimension), high),
                        unit_of(high), "default", note});
        return fallback;
    }
    const toml::array* array = found.node->as_array();
    if (!array || array->size() != 2) {
        problem(found, key, "must be a pair [low, high]",
                fmt::format("such as [{0}, {0}]", example(dimension)));
        return fallback;
    }
    const auto low = value_of(found, *array->get(0), key, dimension, range, example(dimension));
    const auto high = value_of(found, *array->get(1), key, dimension, range, example(dimension));
    if (!low || !high) return fallback;
    if (!(*low < *high)) {
        problem(found, key, "must have low < high", "swap or widen the pair");
        return fallback;
    }
    const std::string last = input_text(*array->get(1));
    reader_.record({path(key), fmt::format("[{}, {}]", input_text(*array->get(0)), last), unit_of(last),
                    found.origin, found.note});
    return {*low, *high};
}

Variable Section::variable(const std::string& key, const std::string& name, const std::string& dimension,
                           const Variable& fallback, const std::string& note, const Range& range,
                           double in_unit) {
    const auto shown = [&](double value) { return format_quantity(value * in_unit, dimension); };
    const TomlReader::Found found = find(key);
    const std::string sample = sample_of(fallback.value * in_unit, dimension, range);
    Variable result = fallback;
    result.name = name;
    if (!found.node) {
        const std::string text = fallback.free ? fmt::format("[{}, {}], start {}", shown(fallback.low),
                                                             shown(fallback.high), shown(fallback.value))
                                               : shown(fallback.value);
        reader_.record({path(key), text, unit_of(shown(fallback.value)), "default", note});
        return result;
    }
    const toml::node* bounds = found.node;
    const toml::node* start = nullptr;
    if (const toml::table* table = found.node->as_table()) {
        Section inner(reader_, table, path(key), found.line);
        bounds = inner.find("range").node;
        start = inner.find("start").node;
        inner.finish();
        if (!bounds) {
            problem(found, key, "is a table without a range",
                    fmt::format("write {{ range = [low, high], start = {} }}", example(dimension)));
            return result;
        }
    }
    if (const toml::array* array = bounds->as_array()) {
        if (array->size() != 2) {
            problem(found, key, "must be a value or a pair [low, high]", "give exactly two bounds");
            return result;
        }
        const auto low = value_of(found, *array->get(0), key, dimension, range, sample);
        const auto high = value_of(found, *array->get(1), key, dimension, range, sample);
        std::optional<double> begin;
        if (start) {
            begin = value_of(found, *start, key, dimension, range, sample);
            if (!begin) return result;
        }
        if (!low || !high) return result;
        if (!(*low < *high)) {
            problem(found, key, "must have low < high",
                    "swap or widen the bounds; a fixed value is written alone");
            return result;
        }
        if (begin && !(*begin >= *low && *begin <= *high)) {
            problem(found, key,
                    fmt::format("the start must lie inside [{}, {}]", format_quantity(*low, dimension),
                                format_quantity(*high, dimension)),
                    "move the start or widen the range");
            return result;
        }
        result.free = true;
        result.low = *low / in_unit;
        result.high = *high / in_unit;
        result.value = begin ? *begin / in_unit : 0.5 * (result.low + result.high);
        const std::string text =
            fmt::format("[{}, {}], start {}", input_text(*array->get(0)), input_text(*array->get(1)),
                        start ? input_text(*start) : shown(result.value));
        reader_.record({path(key), text, unit_of(input_text(*array->get(1))), found.origin, found.note});
        return result;
    }
    if (start) {
        problem(found, key, "has a start but no pair of bounds", "write range = [low, high]");
        return result;
    }
    const auto value = value_of(found, *bounds, key, dimension, range, sample);
    if (!value) return result;
    result.free = false;
    result.value = *value / in_unit;
    result.low = result.high = result.value;
    const std::string text = input_text(*bounds);
    reader_.record({path(key), text, unit_of(text), found.origin, found.note});
    return result;
}

std::vector<double> Section::quantities(const std::string& key, const std::string& dimension,
                                        const std::vector<double>& fallback, const std::string& note,
                                        std::size_t at_least, const Range& range) {
    const auto shown = [&](const std::vector<double>& values) {
        std::vector<std::string> texts;
        for (const double value : values) texts.push_back(format_quantity(value, dimension));
        return joined(texts);
    };
    const TomlReader::Found found = find(key);
    if (!found.node) {
        reader_.record({path(key), shown(fallback), "", "default", note});
        return fallback;
    }
    const std::string sample = dimension.empty() ? format_quantity(fallback.front(), dimension)
                                                 : "\"" + format_quantity(fallback.front(), dimension) + "\"";
    const toml::array* array = found.node->as_array();
    if (!array || array->size() < at_least) {
        problem(found, key, fmt::format("must be a list of at least {}", at_least),
                fmt::format("such as [{}, ...]", sample));
        return fallback;
    }
    std::vector<double> result;
    for (const toml::node& item : *array) {
        TomlReader::Found at = found;
        at.node = &item;
        if (found.line > 0) at.line = static_cast<int>(item.source().begin.line);
        const auto value = value_of(at, item, key, dimension, range, sample);
        if (!value) return fallback;
        if (std::find(result.begin(), result.end(), *value) != result.end()) {
            problem(at, key, "is in the list twice", "leave it out");
            return fallback;
        }
        result.push_back(*value);
    }
    reader_.record({path(key), node_text(*found.node), "", found.origin, found.note});
    return result;
}

std::vector<PlanPoint> Section::points(const std::string& key, std::size_t at_least) {
    const TomlReader::Found found = find(key);
    if (!found.node) return {};
    const toml::array* array = found.node->as_array();
    if (!array || array->size() < at_least) {
        problem(found, key, fmt::format("must be a list of at least {} points", at_least),
                "such as [[\"0 mm\", \"0.4 mm\"], [\"3.2 mm\", \"1.2 mm\"]]");
        return {};
    }
    std::vector<PlanPoint> result;
    for (const toml::node& item : *array) {
        const toml::array* point = item.as_array();
        TomlReader::Found at = found;
        at.node = &item;
        if (found.line > 0) at.line = static_cast<int>(item.source().begin.line);
        if (!point || point->size() != 2) {
            problem(at, key, "each point must be a pair [x, y]", "such as [\"0 mm\", \"0.4 mm\"]");
            return {};
        }
        const auto x = value_of(at, *point->get(0), key, "length", Range::any(), "\"0.4 mm\"");
        const auto y = value_of(at, *point->get(1), key, "length", Range::any(), "\"0.4 mm\"");
        if (!x || !y) return {};
        if (!result.empty() && result.back().x == *x && result.back().y == *y) {
            problem(at, key, "repeats the point before it", "leave it out");
            return {};
        }
        result.push_back({*x, *y});
    }
    reader_.record({path(key), node_text(*found.node), "", found.origin, found.note});
    return result;
}

std::vector<std::string> Section::choices(const std::string& key, const std::vector<std::string>& valid,
                                          const std::string& note, const std::string& set_name,
                                          const std::vector<std::string>& set) {
    const TomlReader::Found found = find(key);
    if (!found.node) {
        reader_.record({path(key), "none", "", "default", note});
        return {};
    }
    if (const auto* word = found.node->as_string(); word && !set_name.empty() && word->get() == set_name) {
        reader_.record({path(key), set_name + ": " + joined(set), "", found.origin, found.note});
        return set;
    }
    const toml::array* array = found.node->as_array();
    if (!array) {
        problem(
            found, key,
            set_name.empty() ? "must be a list of names" : "must be a list of names, or \"" + set_name + "\"",
            "such as [" + quoted_list({valid.front()}) + "]");
        return {};
    }
    std::vector<std::string> result;
    for (const toml::node& item : *array) {
        TomlReader::Found at = found;
        at.node = &item;
        if (found.line > 0) at.line = static_cast<int>(item.source().begin.line);
        const auto* name = item.as_string();
        if (!name || std::find(valid.begin(), valid.end(), name->get()) == valid.end())
            problem(at, key, "must be one of " + quoted_list(valid), hint(name ? name->get() : "", valid));
        else if (std::find(result.begin(), result.end(), name->get()) != result.end())
            problem(at, key, "is named twice", "leave one out");
        else
            result.push_back(name->get());
    }
    reader_.record({path(key), result.empty() ? "none" : joined(result), "", found.origin, found.note});
    return result;
}

}  // namespace gradwright
