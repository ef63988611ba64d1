#include "reports/safe_write.h"

#include <fcntl.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <stdexcept>

namespace gradwright {
namespace {

[[noreturn]] void fail(const std::string& what, const std::string& path, int error) {
    throw std::runtime_error(what + " " + path + ": " + std::strerror(error));
}

/// Closes its descriptor on every way out.
class Descriptor {
  public:
    explicit Descriptor(int value) : value_(value) {}
    ~Descriptor() {
        if (value_ >= 0) ::close(value_);
    }
    Descriptor(const Descriptor&) = delete;
    Descriptor& operator=(const Descriptor&) = delete;
    int value() const { return value_; }

  private:
    int value_;
};

void flush_to_disk(const std::string& path) {
    const Descriptor file(::open(path.c_str(), O_RDONLY | O_CLOEXEC));
    if (file.value() < 0) fail("cannot reopen", path, errno);
    if (::fsync(file.value()) != 0) fail("cannot flush", path, errno);
}

}  // namespace

void write_aside(const std::string& path, const std::function<void(const std::string&)>& write) {
    const std::string aside = path + ".part";
    try {
        write(aside);
        flush_to_disk(aside);
    } catch (...) {
        std::remove(aside.c_str());
        throw;
    }
    if (std::rename(aside.c_str(), path.c_str()) != 0) {
        const int error = errno;
        std::remove(aside.c_str());
        fail("cannot rename onto", path, error);
    }
}

void write_file(const std::string& path, std::string_view content) {
    write_aside(path, [&](const std::string& aside) {
        const Descriptor file(::open(aside.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0666));
        if (file.value() < 0) fail("cannot write", path, errno);
        std::size_t done = 0;
        while (done < content.size()) {
            const ssize_t n = ::write(file.value(), content.data() + done, content.size() - done);
            if (n < 0 && errno == EINTR) continue;
            if (n < 0) fail("cannot write", path, errno);
            done += static_cast<std::size_t>(n);
        }
    });
}

std::string read_file(const std::string& path) {
    errno = 0;
    std::ifstream file(path, std::ios::binary);
    if (!file) fail("cannot read", path, errno ? errno : EIO);
    std::ostringstream text;
    text << file.rdbuf();
    if (file.bad()) fail("cannot read", path, errno ? errno : EIO);
    return text.str();
}

void make_folder(const std::string& folder) {
    std::error_code error;
    std::filesystem::create_directories(folder, error);
    if (error) throw std::runtime_error("cannot create folder " + folder + ": " + error.message());
}

}  // namespace gradwright
