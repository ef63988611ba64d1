// What target.cpp asks of a field (field_target.cpp). Private to targets/.
#pragma once
#include <string>
#include <vector>

#include "targets/target.h"

namespace gradwright {

std::string field_text(const Target& field);  ///< one line for people
std::vector<std::string> field_problems(const Target& field);

}  // namespace gradwright
