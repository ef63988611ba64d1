#include "dem/cache_file.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <atomic>
#include <filesystem>
#include <fstream>
#include <sstream>

#include "dem/scene.h"

namespace gradwright {
namespace {

std::filesystem::path file_of(const std::string& folder, const std::string& kind, const std::string& key) {
    return std::filesystem::path(folder) / fmt::format("{}-{}.bin", kind, text_hash(key));
}

}  // namespace

std::optional<std::string> read_cache(const std::string& folder, const std::string& kind,
                                      const std::string& key) {
    std::ifstream in(file_of(folder, kind, key), std::ios::binary);
    if (!in) return {};
    std::stringstream stream;
    stream << in.rdbuf();
    const std::string all = stream.str();
    constexpr std::size_t kHash = 16;
    if (all.size() < kHash || text_hash(all.substr(0, all.size() - kHash)) != all.substr(all.size() - kHash))
        return {};
    std::size_t at = 0;
    std::vector<char> stored;
    if (!take(all, at, stored) || std::string(stored.begin(), stored.end()) != key) return {};
    return all.substr(at, all.size() - kHash - at);
}

bool write_cache(const std::string& folder, const std::string& kind, const std::string& key,
                 const std::string& bytes) {
    std::string all;
    put(all, std::vector<char>(key.begin(), key.end()));
    all += bytes;
    all += text_hash(all);
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    const auto file = file_of(folder, kind, key);
    static std::atomic<int> written_so_far{0};  // several threads may keep something at once
    const std::string aside = fmt::format("{}.{}-{}.part", file.string(), ::getpid(), written_so_far++);
    const int fd = ::open(aside.c_str(), O_CREAT | O_WRONLY | O_TRUNC, 0644);
    if (fd < 0) return false;
    bool written = true;
    for (std::size_t at = 0; written && at < all.size();) {
        const ssize_t n = ::write(fd, all.data() + at, all.size() - at);
        written = n > 0;
        at += static_cast<std::size_t>(n > 0 ? n : 0);
    }
    written = ::fsync(fd) == 0 && written;
    ::close(fd);
    if (written)
        std::filesystem::rename(aside, file, error);
    else
        std::filesystem::remove(aside, error);
    return written && !error;
}

}  // namespace gradwright
