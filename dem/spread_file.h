// A finished spread as bytes: for the cache of origin maps and for a design that is resumed.
#pragma once
#include <string>

#include "dem/spread.h"

namespace gradwright {

/// Everything of a spread that did not have the energy account, snapshots included, bit for bit.
std::string spread_bytes(const SpreadResult& spread);
/// False for bytes cut short or of another format; `to` is then not to be used.
bool read_spread(const std::string& bytes, SpreadResult& to);

}  // namespace gradwright
