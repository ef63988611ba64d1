// What `gradwright verify` says of a run of the ladder; apart, so that the tests can ask without running it.
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "dem/verification/page.h"

namespace gradwright::cli {

/// {cases[{id, name, quantity, expected, obtained, error, tolerance, pass, source, law}], passed, failed,
/// mutation}. `mutation`: name of the deliberate fault, or empty.
nlohmann::json verify_json(const std::vector<VerificationRun>& runs, const std::string& mutation);

/// Table of one rung, one line a case; `only_red`: cases that passed are left out.
std::string rung_text(const VerificationRung& rung, Precision law, const VerificationCases& cases,
                      bool only_red);

/// Last lines: how many passed; with a mutation which rungs and cases turned red and which should have.
std::string verify_summary(const std::vector<VerificationRun>& runs, const Mutation* mutation);

}  // namespace gradwright::cli
