// Cache files: one per key, written aside, synced, renamed. A file whose length, key or checksum does not fit
// counts as absent, so a damaged one is made anew.
#pragma once
#include <cstdint>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

namespace gradwright {

inline constexpr int kEngineFormat =
    12;  ///< raise when the engine makes other beds or layers from the same scene, or stores more of them

/// Bytes stored under `key`, none when there are none or they are damaged.
std::optional<std::string> read_cache(const std::string& folder, const std::string& kind,
                                      const std::string& key);
/// False when it cannot be written: a cache costs time, not the run.
bool write_cache(const std::string& folder, const std::string& kind, const std::string& key,
                 const std::string& bytes);

template <class T>
void put(std::string& to, const std::vector<T>& values) {
    const std::uint64_t count = values.size();
    to.append(reinterpret_cast<const char*>(&count), sizeof count);
    if (count > 0) to.append(reinterpret_cast<const char*>(values.data()), count * sizeof(T));
}

template <class T>
bool take(const std::string& from, std::size_t& at, std::vector<T>& values) {
    std::uint64_t count = 0;
    if (at + sizeof count > from.size()) return false;
    std::memcpy(&count, from.data() + at, sizeof count);
    at += sizeof count;
    if (count > (from.size() - at) / sizeof(T)) return false;
    values.resize(count);
    // memcpy from or to nothing is undefined even for no bytes
    if (count > 0) std::memcpy(values.data(), from.data() + at, count * sizeof(T));
    at += count * sizeof(T);
    return true;
}

}  // namespace gradwright
