// SHA-256 (FIPS 180-4): what the manifest of a hand-over is written with. Sixty lines here rather than a
// library: libcrypto would be the largest dependency of all for one function.
#pragma once
#include <string>
#include <string_view>

namespace gradwright {

/// Digest as 64 lower-case hex digits.
std::string sha256(std::string_view bytes);

}  // namespace gradwright
