#include "optimise/toml_reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string_view>

#include "optimise/joined.h"

namespace gradwright {
namespace {

constexpr std::size_t kShownCharacters = 60;

std::vector<std::string> split_path(const std::string& path) {
    std::vector<std::string> parts(1);
    for (const char c : path) {
        if (c == '.')
            parts.emplace_back();
        else
            parts.back() += c;
    }
    return parts;
}

/// True when `inner` is `outer` or lies inside it.
bool within(const std::string& inner, const std::string& outer) {
    return inner == outer || (inner.size() > outer.size() && inner.compare(0, outer.size(), outer) == 0 &&
                              (inner[outer.size()] == '.' || inner[outer.size()] == '['));
}

std::string full_text(const toml::node& node) {
    if (const auto* text = node.as_string()) return '"' + text->get() + '"';
    if (const auto* number = node.as_floating_point())
        return fmt::format("{}", number->get());  // shortest, not 17 digits
    std::vector<std::string> parts;
    if (const auto* array = node.as_array()) {
        for (const toml::node& item : *array) parts.push_back(full_text(item));
        return fmt::format("[{}]", joined(parts));
    }
    if (const auto* table = node.as_table()) {
        for (const auto& [key, item] : *table)
            parts.push_back(std::string(key.str()) + " = " + full_text(item));
        return fmt::format("{{ {} }}", joined(parts));
    }
    std::ostringstream out;
    node.visit([&out](const auto& value) { out << value; });
    return out.str();
}

}  // namespace

std::string input_text(const toml::node& node) {
    if (const auto* text = node.as_string()) return text->get();
    return full_text(node);
}

std::string unit_of(const std::string& text) {
    const auto start = text.find_first_not_of("0123456789+-.eE \t");
    if (start == std::string::npos) return "-";
    const auto end = text.find_last_not_of(" \t");
    return text.substr(start, end - start + 1);
}

std::string node_text(const toml::node& node) {
    std::string shown = full_text(node);
    std::replace(shown.begin(), shown.end(), '\n', ' ');
    if (shown.size() > kShownCharacters) {
        std::size_t end = kShownCharacters;
        while (end > 0 && (static_cast<unsigned char>(shown[end]) & 0xC0) == 0x80)
            --end;  // not inside a character
        shown = shown.substr(0, end) + "...";
    }
    return shown;
}

std::string Range::rule(const std::string& dimension) const {
    const bool below = std::isfinite(high), above = std::isfinite(low);
    if (above && below)
        return fmt::format("must lie in {}{}, {}{}", low_open ? '(' : '[', format_quantity(low, dimension),
                           format_quantity(high, dimension), high_open ? ')' : ']');
    if (above) return fmt::format("must be {} {}", low_open ? ">" : ">=", format_quantity(low, dimension));
    if (below) return fmt::format("must be {} {}", high_open ? "<" : "<=", format_quantity(high, dimension));
    return "must be a finite number";
}

// --- the document
// ---------------------------------------------------------------------------------------------------

TomlReader::TomlReader(const std::string& text, const std::string& file,
                       const std::vector<std::string>& overrides)
    : file_(file) {
    try {
        root_ = std::make_shared<toml::table>(toml::parse(text, file));
    } catch (const toml::parse_error& error) {
        throw InputError{{InputProblem{file, static_cast<int>(error.source().begin.line), "", "",
                                       "is not valid TOML: " + std::string(error.description()),
                                       "mend this line; the reading stops at the first such error"}}};
    }
    for (const std::string& override_text : overrides) apply_override(override_text);
}

void TomlReader::apply_override(const std::string& text) {
    const auto equals = text.find('=');
    const std::string path = text.substr(0, equals);
    const std::vector<std::string> parts = split_path(path);
    if (equals == std::string::npos || std::find(parts.begin(), parts.end(), "") != parts.end()) {
        add({"--set", 0, path, "", "must have the form key.path=value",
             "for instance --set design_space.dosage_factor=3.5"});
        return;
    }
    const std::string value = text.substr(equals + 1);
    toml::table parsed;
    try {
        parsed = toml::parse("value = " + value + "\n");
    } catch (const toml::parse_error&) {
        parsed.clear();
    }
    // A shell strips quotes: `--set process.layer_thickness="50 um"` arrives bare, so what is no TOML value
    // is text.
    if (parsed.size() != 1 || !parsed.contains("value")) {
        parsed.clear();
        parsed.insert("value", value);
    }
    toml::table* table = root_.get();
    for (std::size_t i = 0; i + 1 < parts.size(); ++i) {
        toml::node* next = table->get(parts[i]);
        if (!next) next = &table->insert(parts[i], toml::table{}).first->second;
        if (!next->is_table()) {
            add({"--set", 0, path, value, fmt::format("\"{}\" is a value, not a table", parts[i]),
                 "set that key itself"});
            return;
        }
        table = next->as_table();
    }
    table->insert_or_assign(parts.back(), *parsed.get("value"));
    overrides_.insert(path);
}

bool TomlReader::overridden(const std::string& path) const {
    return std::any_of(overrides_.begin(), overrides_.end(),
                       [&path](const std::string& set) { return within(path, set); });
}

const toml::node* TomlReader::node_at(const std::string& path) const {
    const toml::node* node = root_.get();
    for (const std::string& part : split_path(path)) {
        const toml::table* table = node ? node->as_table() : nullptr;
        node = table ? table->get(part) : nullptr;
    }
    return node;
}

void TomlReader::supply(const std::string& path, const toml::node& node, const std::string& file,
                        const std::string& source) {
    supplied_[path] = {&node, file, source};
}

TomlReader::Found TomlReader::locate(const toml::table* table, const std::string& path,
                                     const std::string& key) const {
    if (const toml::node* node = table ? table->get(key) : nullptr) {
        const auto [file, line] = place(path, node);
        return {node, file, line, "given", line == 0 ? "--set" : ""};
    }
    if (const auto it = supplied_.find(path); it != supplied_.end()) {
        const Supplied& supplied = it->second;
        // A number that nobody has measured yet stays visible as such wherever it is used.
        const bool unmeasured =
            supplied.source.empty() || supplied.source.find("measure this") != std::string::npos;
        return {supplied.node, supplied.file, static_cast<int>(supplied.node->source().begin.line),
                unmeasured ? "assumed" : "machine file", supplied.source};
    }
    return {};
}

std::pair<std::string, int> TomlReader::place(const std::string& path, const toml::node* node) const {
    if (overridden(path)) return {"--set", 0};
    return {file_, node ? static_cast<int>(node->source().begin.line) : 0};
}

void TomlReader::record(InputEntry entry) {
    inputs_.push_back(std::move(entry));
}

void TomlReader::derived(const std::string& key, double si, const std::string& dimension,
                         const std::string& note) {
    const std::string text = format_quantity(si, dimension);
    record({key, text, unit_of(text), "default", note});
}

void TomlReader::amend(const std::string& key, const std::string& value, const std::string& origin,
                       const std::string& note) {
    for (InputEntry& entry : inputs_)
        if (entry.key == key) {
            entry.value = value;
            if (!entry.unit.empty()) entry.unit = unit_of(value);
            entry.origin = origin;
            entry.note = note;
        }
}

bool TomlReader::sound(const std::vector<std::string>& keys) const {
    return std::none_of(problems_.begin(), problems_.end(), [&keys](const InputProblem& problem) {
        return std::any_of(keys.begin(), keys.end(), [&problem](const std::string& key) {
            return within(problem.key, key) || within(key, problem.key);
        });
    });
}

bool TomlReader::given(const std::string& key) const {
    return node_at(key) != nullptr;
}

void TomlReader::conflict(const std::vector<std::string>& keys, const std::string& rule,
                          const std::string& mend) {
    for (const std::string& key : keys)
        if (const toml::node* node = node_at(key)) {
            const auto [file, line] = place(key, node);
            add({file, line, key, node_text(*node), rule, mend});
            return;
        }
    for (const std::string& key : keys)
        if (const auto it = supplied_.find(key); it != supplied_.end()) {
            add({it->second.file, static_cast<int>(it->second.node->source().begin.line), key,
                 node_text(*it->second.node), rule, mend});
            return;
        }
    add({file_, 0, keys.front(), "", rule, mend});
}

}  // namespace gradwright
