#include "reports/hdf5_file.h"

#include <hdf5_hl.h>

#include <cerrno>
#include <cstring>

namespace gradwright {
namespace {

H5Handle create_file(const std::string& path) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);  // errors travel as exceptions, not as prints
    errno = 0;
    const hid_t id = H5Fcreate(path.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT);
    return H5Handle(id, H5Fclose, "create " + path + (errno ? std::string(": ") + std::strerror(errno) : ""));
}

void check(herr_t status, const std::string& what) {
    if (status < 0) throw std::runtime_error("HDF5: cannot " + what);
}

H5Handle dataspace(const H5Writer::Shape& shape, const std::string& path) {
    if (shape.empty()) return H5Handle(H5Screate(H5S_SCALAR), H5Sclose, "make a scalar for " + path);
    return H5Handle(H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr), H5Sclose,
                    "make the shape of " + path);
}

H5Handle text_type(std::size_t size, H5T_cset_t set, const std::string& what) {
    H5Handle type(H5Tcopy(H5T_C_S1), H5Tclose, what);
    check(H5Tset_size(type, size), what);
    check(H5Tset_cset(type, set), what);
    check(H5Tset_strpad(type, size == H5T_VARIABLE ? H5T_STR_NULLTERM : H5T_STR_NULLPAD), what);
    return type;
}

H5Handle open_object(hid_t file, const std::string& path) {
    return H5Handle(H5Oopen(file, path.c_str(), H5P_DEFAULT), H5Oclose, "open " + path);
}

/// Link creation that makes missing groups on the way.
H5Handle link_properties(const std::string& what) {
    H5Handle properties(H5Pcreate(H5P_LINK_CREATE), H5Pclose, what);
    check(H5Pset_create_intermediate_group(properties, 1), what);
    return properties;
}

void write_attribute(hid_t file, const std::string& path, const std::string& name, hid_t type,
                     hid_t memory_type, const void* data, const H5Writer::Shape& shape) {
    const std::string what = "write attribute " + name + " of " + path;
    const H5Handle object = open_object(file, path);
    const H5Handle space = dataspace(shape, path);
    const H5Handle attribute(H5Acreate2(object, name.c_str(), type, space, H5P_DEFAULT, H5P_DEFAULT),
                             H5Aclose, what);
    check(H5Awrite(attribute, memory_type, data), what);
}

}  // namespace

H5Writer::H5Writer(const std::string& path) : file_(create_file(path)) {}

void H5Writer::group(const std::string& path) {
    const H5Handle links = link_properties("make " + path);
    const H5Handle made(H5Gcreate2(file_, path.c_str(), links, H5P_DEFAULT, H5P_DEFAULT), H5Gclose,
                        "make group " + path);
}

void H5Writer::write_raw(const std::string& path, hid_t file_type, hid_t memory_type, const void* data,
                         std::size_t count, const Shape& shape) {
    const std::string what = "write " + path;
    hsize_t total = 1;
    for (hsize_t extent : shape) total *= extent;
    if (total != count) throw std::logic_error("HDF5: shape of " + path + " does not hold its values");
    const H5Handle links = link_properties(what);
    const H5Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose, what);
    check(H5Pset_obj_track_times(creation, false), what);
    const H5Handle space = dataspace(shape, path);
    const H5Handle set(H5Dcreate2(file_, path.c_str(), file_type, space, links, creation, H5P_DEFAULT),
                       H5Dclose, what);
    if (count > 0) check(H5Dwrite(set, memory_type, H5S_ALL, H5S_ALL, H5P_DEFAULT, data), what);
}

void H5Writer::write(const std::string& path, std::span<const double> values, const Shape& shape) {
    write_raw(path, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data(), values.size(), shape);
}
void H5Writer::write(const std::string& path, std::span<const float> values, const Shape& shape) {
    write_raw(path, H5T_IEEE_F32LE, H5T_NATIVE_FLOAT, values.data(), values.size(), shape);
}
void H5Writer::write(const std::string& path, std::span<const std::int64_t> values, const Shape& shape) {
    write_raw(path, H5T_STD_I64LE, H5T_NATIVE_INT64, values.data(), values.size(), shape);
}
void H5Writer::write(const std::string& path, std::span<const std::uint8_t> values, const Shape& shape) {
    write_raw(path, H5T_STD_U8LE, H5T_NATIVE_UINT8, values.data(), values.size(), shape);
}

void H5Writer::write_texts(const std::string& path, const std::vector<std::string>& values,
                           const Shape& shape) {
    std::vector<const char*> pointers;
    for (const std::string& value : values) pointers.push_back(value.c_str());
    const H5Handle type = text_type(H5T_VARIABLE, H5T_CSET_UTF8, "write " + path);
    write_raw(path, type, type, pointers.data(), pointers.size(), shape);
}

void H5Writer::attribute(const std::string& path, const std::string& name, const std::string& text,
                         AttributeText kind) {
    if (kind == AttributeText::utf8) {  // variable length: h5py gives it back as str
        const char* pointer = text.c_str();
        const H5Handle type = text_type(H5T_VARIABLE, H5T_CSET_UTF8, "write attribute " + name);
        write_attribute(file_, path, name, type, type, &pointer, {});
    } else {  // fixed length: VTKHDF's reader of VTK 9.1 rejects variable-length text
        const std::string padded = text.empty() ? std::string(1, '\0') : text;
        const H5Handle type = text_type(padded.size(), H5T_CSET_ASCII, "write attribute " + name);
        write_attribute(file_, path, name, type, type, padded.data(), {});
    }
}
void H5Writer::attribute(const std::string& path, const std::string& name,
                         std::span<const std::int64_t> values) {
    write_attribute(file_, path, name, H5T_STD_I64LE, H5T_NATIVE_INT64, values.data(), {values.size()});
}
void H5Writer::attribute(const std::string& path, const std::string& name, std::span<const double> values) {
    write_attribute(file_, path, name, H5T_IEEE_F64LE, H5T_NATIVE_DOUBLE, values.data(), {values.size()});
}

void H5Writer::make_scale(const std::string& path, const std::string& name) {
    const H5Handle set = open_object(file_, path);
    check(H5DSset_scale(set, name.c_str()), "make " + path + " a dimension scale");
}

void H5Writer::attach_scale(const std::string& path, const std::string& scale, unsigned dimension) {
    const H5Handle set = open_object(file_, path);
    const H5Handle ruler = open_object(file_, scale);
    check(H5DSattach_scale(set, ruler, dimension), "attach " + scale + " to " + path);
}

void H5Writer::flush() {
    check(H5Fflush(file_, H5F_SCOPE_GLOBAL), "flush the file: is the disk full?");
}

}  // namespace gradwright
