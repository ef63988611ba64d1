// Reads tables of a TOML file into plain numbers, keeps every value for the report (InputEntry) and every
// problem with its file, line, key, value, rule and mend. A reading never stops at a problem: it goes on with
// the default, so that all problems of a file come in one go.
#pragma once
#include <toml++/toml.h>

#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "optimise/study_file.h"

namespace gradwright {

/// Interval a number must lie in, ends in SI.
struct Range {
    double low = -std::numeric_limits<double>::infinity();
    double high = std::numeric_limits<double>::infinity();
    bool low_open = false, high_open = false;

    bool holds(double value) const {
        return (low_open ? value > low : value >= low) && (high_open ? value < high : value <= high);
    }
    /// "must be > 0", "must lie in (0, 1]", with units of `dimension` ("" = plain number).
    std::string rule(const std::string& dimension) const;

    static Range any() { return {}; }
    static Range above(double low) { return {.low = low, .low_open = true}; }
    static Range at_least(double low) { return {.low = low}; }
    static Range between(double low, double high) { return {.low = low, .high = high}; }
    static Range above_to(double low, double high) { return {.low = low, .high = high, .low_open = true}; }
};

/// What stands in for a value that is not given.
struct Default {
    double value = 0;                ///< SI
    std::string note;                ///< source or reason
    std::string origin = "default";  ///< "default" | "assumed"
    bool required = false;           ///< true: a missing value is a problem; `note` is the mend
};
inline Default required(std::string mend) {
    return {.note = std::move(mend), .required = true};
}

/// The whole document with its overrides, problems and inputs.
class TomlReader {
  public:
    /// Throws InputError when the text is no TOML (the parser stops at the first such error).
    TomlReader(const std::string& text, const std::string& file, const std::vector<std::string>& overrides);

    const toml::table& root() const { return *root_; }
    const std::string& file() const { return file_; }

    /// Another file stands in where the study says nothing: `path` -> its node. `document` is kept alive.
    void supply(const std::string& path, const toml::node& node, const std::string& file,
                const std::string& source);
    void keep(std::shared_ptr<toml::table> document) { kept_.push_back(std::move(document)); }

    struct Found {
        const toml::node* node = nullptr;
        std::string file;
        int line = 0;
        std::string origin, note;
    };
    /// The study's own node, else the supplied one, else null.
    Found locate(const toml::table* table, const std::string& path, const std::string& key) const;
    /// File and line of a node of the study ("--set" and 0 when an override put it there).
    std::pair<std::string, int> place(const std::string& path, const toml::node* node) const;

    void add(InputProblem problem) { problems_.push_back(std::move(problem)); }
    void record(InputEntry entry);
    /// Records a value that follows from others.
    void derived(const std::string& key, double si, const std::string& dimension, const std::string& note);
    /// Replaces the value of a recorded input (what a reduction changed).
    void amend(const std::string& key, const std::string& value, const std::string& origin,
               const std::string& note);
    /// True when none of these keys, nor anything inside them, has a problem so far.
    bool sound(const std::vector<std::string>& keys) const;
    bool given(const std::string& key) const;
    /// A rule between several values: the problem stands at the first of them that the user wrote.
    void conflict(const std::vector<std::string>& keys, const std::string& rule, const std::string& mend);

    std::vector<InputProblem>& problems() { return problems_; }
    std::vector<InputEntry>& inputs() { return inputs_; }

  private:
    void apply_override(const std::string& text);
    bool overridden(const std::string& path) const;
    const toml::node* node_at(const std::string& path) const;

    struct Supplied {
        const toml::node* node;
        std::string file, source;
    };
    std::string file_;
    std::shared_ptr<toml::table> root_;
    std::vector<std::shared_ptr<toml::table>> kept_;
    std::set<std::string> overrides_;
    std::map<std::string, Supplied> supplied_;
    std::vector<InputProblem> problems_;
    std::vector<InputEntry> inputs_;
};

/// One table of the document (or its absence). Every accessor makes its key a known one; `finish` reports the
/// rest.
class Section {
  public:
    Section(TomlReader& reader, const toml::table* table, std::string path, int line)
        : reader_(reader), table_(table), path_(std::move(path)), line_(line) {}

    Section sub(const std::string& key);
    bool has(const std::string& key) const;
    /// A key that is known here but has no place in this context: its presence is a problem with this rule
    /// and mend.
    void refuse(const std::string& key, const std::string& rule, const std::string& mend);
    void know(const std::string& key) { known_.push_back(key); }
    /// Unknown keys, each with the nearest valid name.
    void finish();

    /// A quantity with a unit; `dimension` "" is a plain number. SI.
    double quantity(const std::string& key, const std::string& dimension, const Default& fallback,
                    const Range& range);
    double number(const std::string& key, const Default& fallback, const Range& range) {
        return quantity(key, "", fallback, range);
    }
    long integer(const std::string& key, long fallback, const std::string& note, long low, long high);
    bool boolean(const std::string& key, bool fallback, const std::string& note);
    std::string text(const std::string& key, const std::string& fallback, const std::string& note);
    std::string choice(const std::string& key, const std::vector<std::string>& valid,
                       const std::string& fallback, const std::string& note);
    /// Fixed number, [low, high] or { range = [low, high], start = number }. `in_unit`: SI of the unit the
    /// Variable is kept in (1 = SI; pi/180 for degrees).
    Variable variable(const std::string& key, const std::string& name, const std::string& dimension,
                      const Variable& fallback, const std::string& note, const Range& range,
                      double in_unit = 1);
    /// [low, high] of quantities, low < high.
    std::pair<double, double> pair(const std::string& key, const std::string& dimension,
                                   std::pair<double, double> fallback, const std::string& note,
                                   const Range& range);
    /// A list of quantities, all different, in the order given; `fallback` is used and noted when there is
    /// none.
    std::vector<double> quantities(const std::string& key, const std::string& dimension,
                                   const std::vector<double>& fallback, const std::string& note,
                                   std::size_t at_least, const Range& range);
    /// [["0 mm", "0.4 mm"], ...] of plan points.
    std::vector<PlanPoint> points(const std::string& key, std::size_t at_least);
    /// A list of names, or the single word `set_name` for all of `set`.
    std::vector<std::string> choices(const std::string& key, const std::vector<std::string>& valid,
                                     const std::string& note, const std::string& set_name = "",
                                     const std::vector<std::string>& set = {});

    std::string path(const std::string& key) const { return path_.empty() ? key : path_ + "." + key; }
    TomlReader::Found find(const std::string& key);
    void problem(const TomlReader::Found& found, const std::string& key, const std::string& rule,
                 const std::string& mend);
    /// Reports a key that must be there and is not.
    void missing(const std::string& key, const std::string& mend);

  private:
    /// `sample`: a sound value to show in a mend.
    std::optional<double> value_of(const TomlReader::Found& found, const toml::node& node,
                                   const std::string& key, const std::string& dimension, const Range& range,
                                   const std::string& sample);

    TomlReader& reader_;
    const toml::table* table_;
    std::string path_;
    int line_;
    std::vector<std::string> known_;
};

/// "um" of "40 um"; "-" of a plain number.
std::string unit_of(const std::string& text);

/// A value for the list of inputs: strings without their quotes.
std::string input_text(const toml::node& node);

/// A node as the user would write it, shortened to 60 characters.
std::string node_text(const toml::node& node);

}  // namespace gradwright
