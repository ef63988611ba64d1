// Small RAII layer over the HDF5 C API: a handle closes itself, every failing call throws with what was being
// done.
#pragma once
#include <hdf5.h>

#include <cstdint>
#include <span>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace gradwright {

/// Owns one HDF5 identifier.
class H5Handle {
  public:
    using Close = herr_t (*)(hid_t);
    /// Throws std::runtime_error("HDF5: cannot <what>") when `id` is invalid.
    H5Handle(hid_t id, Close close, const std::string& what) : id_(id), close_(close) {
        if (id < 0) throw std::runtime_error("HDF5: cannot " + what);
    }
    H5Handle(H5Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
    H5Handle(const H5Handle&) = delete;
    H5Handle& operator=(const H5Handle&) = delete;
    H5Handle& operator=(H5Handle&&) = delete;
    ~H5Handle() {
        if (id_ >= 0) close_(id_);
    }
    operator hid_t() const { return id_; }

  private:
    hid_t id_;
    Close close_;
};

enum class AttributeText { utf8, ascii };

/// A file being written. Paths are absolute ("/result/gi"); groups on the way are made. No time stamps are
/// stored, so equal content gives equal bytes.
class H5Writer {
  public:
    using Shape = std::vector<hsize_t>;

    explicit H5Writer(const std::string& path);

    void group(const std::string& path);
    /// Datasets: row-major, `shape` must multiply to the number of values (empty shape = scalar).
    void write(const std::string& path, std::span<const double> values, const Shape& shape);
    void write(const std::string& path, std::span<const float> values, const Shape& shape);
    void write(const std::string& path, std::span<const std::int64_t> values, const Shape& shape);
    void write(const std::string& path, std::span<const std::uint8_t> values, const Shape& shape);
    /// Variable-length UTF-8 texts.
    void write_texts(const std::string& path, const std::vector<std::string>& values, const Shape& shape);

    /// `utf8`: variable length; `ascii`: fixed length.
    void attribute(const std::string& path, const std::string& name, const std::string& text,
                   AttributeText kind = AttributeText::utf8);
    void attribute(const std::string& path, const std::string& name, std::span<const std::int64_t> values);
    void attribute(const std::string& path, const std::string& name, std::span<const double> values);

    /// Makes a dataset a dimension scale named `name`.
    void make_scale(const std::string& path, const std::string& name);
    /// Attaches the scale at `scale` to dimension `dimension` of the dataset at `path`.
    void attach_scale(const std::string& path, const std::string& scale, unsigned dimension);
    /// Flushes; throws when the disk refuses.
    void flush();

  private:
    void write_raw(const std::string& path, hid_t file_type, hid_t memory_type, const void* data,
                   std::size_t count, const Shape& shape);
    H5Handle file_;
};

}  // namespace gradwright
