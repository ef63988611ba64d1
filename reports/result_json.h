// The JSON that scripts rely on: one object for `design`, one for `evaluate`. Field names are a promise: add
// freely, rename none. Lengths in m, everything SI, undefined = null.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "optimise/evaluation.h"
#include "optimise/study.h"
#include "optimise/study_result.h"

namespace gradwright {

/// `design`: also the content of result.json. `files`: what was written, relative to the output folder (as
/// write_outputs returns it).
nlohmann::json to_json(const Study& study, const StudyResult& result,
                       const std::vector<std::string>& files = {});

/// `evaluate`: one design at one fidelity.
nlohmann::json evaluation_json(const Study& study, const Evaluation& evaluation,
                               const std::vector<std::string>& files = {});

// Parts shared with the report and partition.json.
nlohmann::json design_json(const Study& study, const Design& design);
/// [{name, kind, unit, value, at_least, at_most, slack, kept}]; an open bound is null.
nlohmann::json constraints_json(const std::vector<ConstraintState>& states);
nlohmann::json misfit_json(const Misfit& misfit);
nlohmann::json inputs_json(const Study& study);

}  // namespace gradwright
