// SPDX-License-Identifier: GPL-3.0-or-later
#include "hdf5_edit.hpp"

#include <fstream>
#include <iterator>
#include <numeric>
#include <stdexcept>

namespace pamr::test {

namespace {

/// Identifier that is closed at the end of the scope.
class Id {
 public:
  Id(hid_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {
    if (id < 0) throw std::runtime_error("HDF5 refuses");
  }
  ~Id() { close_(id_); }
  Id(const Id&) = delete;
  Id& operator=(const Id&) = delete;
  Id(Id&&) = delete;
  Id& operator=(Id&&) = delete;
  hid_t get() const { return id_; }

 private:
  hid_t id_;
  herr_t (*close_)(hid_t);
};

void require(bool good) {
  if (!good) throw std::runtime_error("HDF5 refuses");
}

Id open(const std::filesystem::path& file, unsigned mode = H5F_ACC_RDWR) {
  return {H5Fopen(file.c_str(), mode, H5P_DEFAULT), H5Fclose};
}

std::size_t n_values(const Shape& shape) {
  return std::accumulate(shape.begin(), shape.end(), std::size_t{1},
                         [](std::size_t a, hsize_t b) { return a * static_cast<std::size_t>(b); });
}

void forget_checksum(hid_t file, const std::string& path) {
  if (H5Lexists(file, "/PAMR", H5P_DEFAULT) <= 0 || H5Lexists(file, "/PAMR/checksums", H5P_DEFAULT) <= 0) return;
  const Id group(H5Gopen2(file, "/PAMR/checksums", H5P_DEFAULT), H5Gclose);
  if (H5Aexists(group.get(), path.substr(1).c_str()) > 0) H5Adelete(group.get(), path.substr(1).c_str());
}

void replace(hid_t file, const std::string& path) {
  if (H5Lexists(file, path.c_str(), H5P_DEFAULT) > 0) require(H5Ldelete(file, path.c_str(), H5P_DEFAULT) >= 0);
  forget_checksum(file, path);
}

}  // namespace

void create_file(const std::filesystem::path& file) {
  const Id h5(H5Fcreate(file.c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT), H5Fclose);
}

void create_group(const std::filesystem::path& file, const std::string& path) {
  const auto h5 = open(file);
  const Id group(H5Gcreate2(h5.get(), path.c_str(), H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT), H5Gclose);
}

void remove_object(const std::filesystem::path& file, const std::string& path) {
  const auto h5 = open(file);
  require(H5Ldelete(h5.get(), path.c_str(), H5P_DEFAULT) >= 0);
}

bool has_object(const std::filesystem::path& file, const std::string& path) {
  const auto h5 = open(file, H5F_ACC_RDONLY);
  return H5Lexists(h5.get(), path.c_str(), H5P_DEFAULT) > 0;
}

void make_soft_link(const std::filesystem::path& file, const std::string& target, const std::string& path) {
  const auto h5 = open(file);
  require(H5Lcreate_soft(target.c_str(), h5.get(), path.c_str(), H5P_DEFAULT, H5P_DEFAULT) >= 0);
}

void write_dataset_raw(const std::filesystem::path& file, const std::string& path, const Shape& shape, hid_t type,
                       const void* values, Storage storage) {
  const auto h5 = open(file);
  replace(h5.get(), path);
  const Id space(
      shape.empty() ? H5Screate(H5S_SCALAR) : H5Screate_simple(static_cast<int>(shape.size()), shape.data(), nullptr),
      H5Sclose);
  const Id properties(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
  if (storage.chunk > 0) {
    auto chunk = shape;
    chunk[0] = storage.chunk;
    H5Pset_chunk(properties.get(), static_cast<int>(chunk.size()), chunk.data());
    H5Pset_shuffle(properties.get());
    H5Pset_deflate(properties.get(), 6);
  }
  const Id dataset(H5Dcreate2(h5.get(), path.c_str(), storage.file_type != 0 ? storage.file_type : type, space.get(),
                              H5P_DEFAULT, properties.get(), H5P_DEFAULT),
                   H5Dclose);
  require(n_values(shape) == 0 || H5Dwrite(dataset.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values) >= 0);
}

void write_texts(const std::filesystem::path& file, const std::string& path, const std::vector<std::string>& texts) {
  std::vector<const char*> pointers;
  for (const auto& text : texts) pointers.push_back(text.c_str());
  const Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), H5T_VARIABLE);
  H5Tset_cset(type.get(), H5T_CSET_UTF8);
  write_dataset_raw(file, path, {texts.size()}, type.get(), pointers.data(), {});
}

void read_dataset_raw(const std::filesystem::path& file, const std::string& path, hid_t type,
                      std::vector<std::byte>& values, std::size_t size) {
  const auto n = n_values(shape_of(file, path));
  const auto h5 = open(file, H5F_ACC_RDONLY);
  const Id dataset(H5Dopen2(h5.get(), path.c_str(), H5P_DEFAULT), H5Dclose);
  values.resize(n * size);
  require(H5Dread(dataset.get(), type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values.data()) >= 0);
}

Shape shape_of(const std::filesystem::path& file, const std::string& path) {
  const auto h5 = open(file, H5F_ACC_RDONLY);
  const Id dataset(H5Dopen2(h5.get(), path.c_str(), H5P_DEFAULT), H5Dclose);
  const Id space(H5Dget_space(dataset.get()), H5Sclose);
  Shape shape(static_cast<std::size_t>(H5Sget_simple_extent_ndims(space.get())));
  H5Sget_simple_extent_dims(space.get(), shape.data(), nullptr);
  return shape;
}

void remove_attribute(const std::filesystem::path& file, const std::string& path, const std::string& name) {
  const auto h5 = open(file);
  require(H5Adelete_by_name(h5.get(), path.c_str(), name.c_str(), H5P_DEFAULT) >= 0);
}

void write_attribute(const std::filesystem::path& file, const std::string& path, const std::string& name,
                     const std::vector<std::int64_t>& values) {
  const auto h5 = open(file);
  const Id object(H5Oopen(h5.get(), path.c_str(), H5P_DEFAULT), H5Oclose);
  if (H5Aexists(object.get(), name.c_str()) > 0) H5Adelete(object.get(), name.c_str());
  const hsize_t n = values.size();
  const Id space(H5Screate_simple(1, &n, nullptr), H5Sclose);
  const Id attribute(H5Acreate2(object.get(), name.c_str(), H5T_NATIVE_INT64, space.get(), H5P_DEFAULT, H5P_DEFAULT),
                     H5Aclose);
  require(H5Awrite(attribute.get(), H5T_NATIVE_INT64, values.data()) >= 0);
}

void write_attribute(const std::filesystem::path& file, const std::string& path, const std::string& name,
                     const std::string& text) {
  const auto h5 = open(file);
  const Id object(H5Oopen(h5.get(), path.c_str(), H5P_DEFAULT), H5Oclose);
  if (H5Aexists(object.get(), name.c_str()) > 0) H5Adelete(object.get(), name.c_str());
  const Id type(H5Tcopy(H5T_C_S1), H5Tclose);
  H5Tset_size(type.get(), text.size());
  const Id space(H5Screate(H5S_SCALAR), H5Sclose);
  const Id attribute(H5Acreate2(object.get(), name.c_str(), type.get(), space.get(), H5P_DEFAULT, H5P_DEFAULT),
                     H5Aclose);
  require(H5Awrite(attribute.get(), type.get(), text.c_str()) >= 0);
}

std::uint64_t read_unsigned_attribute(const std::filesystem::path& file, const std::string& path,
                                      const std::string& name) {
  const auto h5 = open(file, H5F_ACC_RDONLY);
  const Id attribute(H5Aopen_by_name(h5.get(), path.c_str(), name.c_str(), H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
  std::uint64_t value = 0;
  require(H5Aread(attribute.get(), H5T_NATIVE_UINT64, &value) >= 0);
  return value;
}

Extent extent_of(const std::filesystem::path& file, const std::string& path) {
  const auto h5 = open(file, H5F_ACC_RDONLY);
  const Id dataset(H5Dopen2(h5.get(), path.c_str(), H5P_DEFAULT), H5Dclose);
  return {H5Dget_offset(dataset.get()), H5Dget_storage_size(dataset.get())};
}

Extent first_chunk_of(const std::filesystem::path& file, const std::string& path) {
  const auto h5 = open(file, H5F_ACC_RDONLY);
  const Id dataset(H5Dopen2(h5.get(), path.c_str(), H5P_DEFAULT), H5Dclose);
  const Id space(H5Dget_space(dataset.get()), H5Sclose);
  haddr_t offset = 0;
  hsize_t bytes = 0;
  require(H5Dget_chunk_info(dataset.get(), space.get(), 0, nullptr, nullptr, &offset, &bytes) >= 0);
  return {offset, bytes};
}

void flip_byte(const std::filesystem::path& file, std::uint64_t offset) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekg(static_cast<std::streamoff>(offset));
  const auto byte = static_cast<char>(~stream.get());
  stream.seekp(static_cast<std::streamoff>(offset));
  stream.put(byte);
}

std::string bytes_of(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

}  // namespace pamr::test
