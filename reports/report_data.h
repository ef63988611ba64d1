// Everything the report shows, as one JSON object: the page holds it in one block, OUT/report_data.json holds
// it for `report OUT`.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "optimise/study.h"
#include "optimise/study_result.h"

namespace gradwright {

/// {format, result (as result.json), words, build, plan, map, origin, pictures, speed, reduction_cost,
/// command, study_text}. Lengths in m unless the name says mm; undefined = null. `files`: what lies beside
/// the report.
nlohmann::json report_data(const Study& study, const StudyResult& result,
                           const std::vector<std::string>& files = {},
                           const std::vector<std::string>& called_with = {});

/// Which of `count` instants are drawn and written for ParaView: the first, the last and evenly between them,
/// at most `most`; a film keeps many more.
std::vector<std::size_t> shown_instants(std::size_t count, std::size_t most = 5);

}  // namespace gradwright
