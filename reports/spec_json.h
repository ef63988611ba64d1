// spec.json: the hand-over for scripts; docs/schema/spec.schema.json says what is in it.
#pragma once
#include <nlohmann/json.hpp>

#include "reports/hand_over.h"

namespace gradwright {

/// `files`: names in the folder, spec.json and the manifest included.
nlohmann::json spec_json(const Study& study, const FinishedDesign& finished, const HandOver& over,
                         const std::vector<std::string>& files);

}  // namespace gradwright
