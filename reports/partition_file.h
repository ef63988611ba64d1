// partition.json: everything a workshop or a script needs to make the partition, in m and mm.
#pragma once
#include <nlohmann/json.hpp>

#include "optimise/study.h"
#include "optimise/study_result.h"

namespace gradwright {

/// Corners (m and mm), the family's parameters, sides, dispenser, end offsets along the walls, powders,
/// doses.
nlohmann::json partition_json(const Study& study, const StudyResult& result);

}  // namespace gradwright
