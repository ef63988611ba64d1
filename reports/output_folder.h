// The output folder of `design`: every file whole or not there.
#pragma once
#include <string>
#include <vector>

#include "optimise/study.h"
#include "optimise/study_result.h"

namespace gradwright {

/// Whether film.webp is drawn too (film.h): only when the spread kept instants for it, and never without one.
enum class Film { none, drawn };

/// Writes result.json, results.h5, report.html, report_data.json, partition.json, partition.svg,
/// gi_map.vtkhdf, particles_*.vtkhdf with particles.vtkhdf.series, study.toml (verbatim) and, when asked for,
/// film.webp into `folder` (made when missing). Returns the names written, relative to `folder`, in the order
/// above. Throws std::runtime_error with path and system text on any I/O error (exit code 6).
std::vector<std::string> write_outputs(const Study& study, const StudyResult& result,
                                       const std::string& folder, Film film = Film::none,
                                       const std::vector<std::string>& called_with = {});

/// `report OUT`: rebuilds OUT/report.html from OUT/report_data.json. Returns the page's path. Throws
/// std::runtime_error.
std::string rebuild_report(const std::string& folder);

}  // namespace gradwright
