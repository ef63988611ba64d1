// Settled beds on disk: one file per bed, key = every number that shapes the bed. Written aside, synced, renamed; a file whose
// length, key or checksum does not fit is made anew.
#include <fcntl.h>
#include <omp.h>
#include <unistd.h>

#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <fmt/format.h>

#include "dem/bed.h"

namespace gradwright {
namespace {

constexpr int kEngineFormat = 2;  // raise when the engine makes other beds from the same scene

std::string bed_key(const Scene& scene, const PartitionCurve* partition) {
    Scene s = scene;  // what the bed does not depend on is blanked, so that other lands and gaps find the same bed
    s.land = s.platform_length = s.second_land = s.gap = s.layer_thickness = 0;
    s.blade_speed = s.blade_tip_radius = s.blade_thickness = 0;
    s.headspace = {0, 0};
    s.substrate = Substrate::fused;
    s.sleep = false;
    s.dispenser_depth = 0;
    std::string text = fmt::format("format {}\n{}", kEngineFormat, s.canonical_text());
    if (partition)
        for (const auto& p : partition->points) text += fmt::format("{:.17g} {:.17g}\n", p.x, p.y);
    return text;
}

template <class T>
void put(std::string& to, const std::vector<T>& values) {
    const std::uint64_t count = values.size();
    to.append(reinterpret_cast<const char*>(&count), sizeof count);
    to.append(reinterpret_cast<const char*>(values.data()), count * sizeof(T));
}

template <class T>
bool take(const std::string& from, std::size_t& at, std::vector<T>& values) {
    std::uint64_t count = 0;
    if (at + sizeof count > from.size()) return false;
    std::memcpy(&count, from.data() + at, sizeof count);
    at += sizeof count;
    if (count > (from.size() - at) / sizeof(T)) return false;
    values.resize(count);
    std::memcpy(values.data(), from.data() + at, count * sizeof(T));
    at += count * sizeof(T);
    return true;
}

std::string pack_bytes(const Bed& bed, const std::string& key) {
    std::string out;
    put(out, std::vector<char>(key.begin(), key.end()));
    put(out, bed.x);
    put(out, bed.y);
    put(out, bed.z);
    put(out, bed.radius);
    put(out, bed.material);
    const auto& f = bed.facts;
    put(out, std::vector<double>{f.packing_fraction, f.mean_coordination, f.max_overlap_ratio, f.speed_number, f.carried_weight_ratio,
                                 static_cast<double>(f.steps), f.seconds_cold});
    put(out, f.made_d10_d50_d90);
    return out + text_hash(out);
}

bool unpack(const std::string& bytes, const std::string& key, Bed& bed) {
    if (bytes.size() < 16 || text_hash(bytes.substr(0, bytes.size() - 16)) != bytes.substr(bytes.size() - 16)) return false;
    std::size_t at = 0;
    std::vector<char> stored;
    std::vector<double> facts;
    if (!take(bytes, at, stored) || std::string(stored.begin(), stored.end()) != key) return false;
    if (!take(bytes, at, bed.x) || !take(bytes, at, bed.y) || !take(bytes, at, bed.z) || !take(bytes, at, bed.radius) ||
        !take(bytes, at, bed.material) || !take(bytes, at, facts) || !take(bytes, at, bed.facts.made_d10_d50_d90) || facts.size() != 7)
        return false;
    auto& f = bed.facts;
    f.packing_fraction = facts[0];
    f.mean_coordination = facts[1];
    f.max_overlap_ratio = facts[2];
    f.speed_number = facts[3];
    f.carried_weight_ratio = facts[4];
    f.steps = static_cast<long>(facts[5]);
    f.seconds_cold = facts[6];
    f.from_cache = true;
    return true;
}

}  // namespace

Bed cached_bed(const Scene& scene, const PartitionCurve* partition, const SpreadOptions& options, RunHealth& health) {
    if (options.cache_folder.empty()) return pack_bed(scene, partition, options, health);
    const double start = omp_get_wtime();
    const std::string key = bed_key(scene, partition);
    const std::filesystem::path folder = options.cache_folder, file = folder / ("bed-" + text_hash(key) + ".bin");
    {
        std::ifstream in(file, std::ios::binary);
        std::stringstream bytes;
        if (in) bytes << in.rdbuf();
        Bed bed;
        if (in && unpack(bytes.str(), key, bed)) {
            bed.facts.seconds = omp_get_wtime() - start;
            health.status = "ok";
            return bed;
        }
    }
    Bed bed = pack_bed(scene, partition, options, health);
    if (!health.ok()) return bed;
    // A cache that cannot be written costs time, not the run.
    std::error_code ignored;
    std::filesystem::create_directories(folder, ignored);
    const std::string bytes = pack_bytes(bed, key), aside = fmt::format("{}.{}.part", file.string(), ::getpid());
    const int fd = ::open(aside.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0644);
    bool written = fd >= 0;
    for (std::size_t at = 0; written && at < bytes.size();) {
        const ssize_t n = ::write(fd, bytes.data() + at, bytes.size() - at);
        written = n > 0;
        at += static_cast<std::size_t>(n > 0 ? n : 0);
    }
    if (fd >= 0) {
        written = ::fsync(fd) == 0 && written;
        ::close(fd);
    }
    if (written) std::filesystem::rename(aside, file, ignored);
    else {
        std::filesystem::remove(aside, ignored);
        health.warnings.push_back(fmt::format("the bed cache {} cannot be written; beds are packed anew each time", folder.string()));
    }
    return bed;
}

}  // namespace gradwright
