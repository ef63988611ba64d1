// OUT/spec: the hand-over's files, each whole or not there, and the manifest over them.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "reports/hand_over.h"
#include "reports/step_file.h"

namespace gradwright {

/// Every name that write_spec may give a file.
inline constexpr std::array<const char*, 9> kSpecNames = {
    "partition.step", "partition.stl",   "flat_pattern.dxf", "drawing.pdf",    "drawing.svg",
    "fill_sheet.pdf", "fill_sheet.html", "spec.json",        "manifest.sha256"};

struct SpecFiles {
    std::vector<std::string> names;  ///< in the folder, in the order written; the manifest is the last
    bool step = true;                ///< false: built without OpenCASCADE, partition.step is not there
    std::string step_problem;        ///< why OpenCASCADE could not write it; empty otherwise
};

/// Writes partition.step, partition.stl, flat_pattern.dxf, drawing.pdf, drawing.svg, fill_sheet.pdf,
/// fill_sheet.html, spec.json and manifest.sha256 ("sha256sum -c" reads it) into `folder`, made when missing.
/// The same hand-over gives the same bytes. A plate whose checks failed may have no solid: then
/// partition.step is missing and step_problem says why. Throws std::runtime_error on any I/O error.
SpecFiles write_spec(const Study& study, const FinishedDesign& finished, const HandOver& over,
                     StepSchema schema, const std::string& folder);

}  // namespace gradwright
