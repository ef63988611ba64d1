// Files that are either whole or not there: written aside, flushed to the disk, renamed. A kill at any byte
// leaves the old file.
#pragma once
#include <functional>
#include <string>
#include <string_view>

namespace gradwright {

/// Replaces `path` by `content`. Throws std::runtime_error naming the path and the system's reason.
void write_file(const std::string& path, std::string_view content);
/// For writers that need a path (HDF5): `write` fills the temporary path it is given; then flush and rename
/// as above.
void write_aside(const std::string& path, const std::function<void(const std::string& aside)>& write);
/// Whole file as text. Throws std::runtime_error naming the path and the system's reason.
std::string read_file(const std::string& path);
/// Creates the folder and its parents. Throws std::runtime_error naming the path and the system's reason.
void make_folder(const std::string& folder);

}  // namespace gradwright
