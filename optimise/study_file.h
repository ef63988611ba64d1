// Study file (TOML) -> Study. All problems of a file at once, each with file, line, key, value, rule and how
// to mend.
#pragma once
#include <string>
#include <vector>

#include "optimise/study.h"

namespace gradwright {

struct InputProblem {
    std::string file;
    int line = 0;  ///< 1-based, 0 = not tied to a line
    std::string key, value, rule, mend;
    std::string text() const;  ///< "file:line: key = value: rule; mend"
};

/// Thrown when a file cannot be used; carries every problem found.
struct InputError {
    std::vector<InputProblem> problems;
};
/// The problems numbered, one a line, for people. Ends with a newline.
std::string report_of(const InputError& error);

/// `overrides`: "key.path=toml value", applied before validation (from --set).
Study read_study(const std::string& file, const std::vector<std::string>& overrides = {});
Study parse_study(const std::string& text, const std::string& file_name,
                  const std::vector<std::string>& overrides = {});

/// "40 um", "0.02 J/m2", "5 deg", "100 mm/s" -> SI number. `dimension`: "length", "speed", "angle",
/// "work_of_adhesion", "pressure", "density", "acceleration". Throws std::invalid_argument with the rule.
double parse_quantity(const std::string& text, const std::string& dimension);

/// An SI number for people: "40 um", "3.2 mm", "100 mm/s", "195 GPa"; 6 significant digits, the unit that
/// reads best. `dimension` as in parse_quantity; "" = a plain number.
std::string format_quantity(double si, const std::string& dimension);

/// Nearest of `valid` to `word` by edit distance; empty when nothing is near.
std::string nearest_name(const std::string& word, const std::vector<std::string>& valid);

struct MachineNumber {
    std::string key;        ///< "dispenser.length"
    std::string value;      ///< as written: "250 mm"
    std::string source;     ///< its own, else the file's
    bool measured = false;  ///< false: a stand-in, the source says "measure this"
};
struct MachineInfo {
    std::string name, title, source;
    std::string file;
    std::vector<MachineNumber> numbers;
};
std::vector<MachineInfo> shipped_machines();  ///< from examples/machines/*.toml
std::vector<Material> shipped_materials();    ///< from examples/materials.toml; each with its source
/// Folder of the shipped data: GRADWRIGHT_DATA, else share/gradwright beside the running program, else the
/// source tree's examples. A program of your own that links the installed library sets GRADWRIGHT_DATA to
/// what find_package gives as GRADWRIGHT_DATA_FOLDER (examples/library).
std::string data_folder();

}  // namespace gradwright
