// "a, b, c". Not fmt::join: GCC 12 at -O3 reports a false overflow inside fmt 9's range formatter.
#pragma once
#include <string>
#include <vector>

namespace gradwright {

inline std::string joined(const std::vector<std::string>& names) {
    std::string result;
    for (const std::string& name : names) result += (result.empty() ? "" : ", ") + name;
    return result;
}

}  // namespace gradwright
