// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <string>
#include <type_traits>
#include <vector>

/// Edits HDF5 files serially, as a script with h5py would. Every function opens the file, does one thing and closes it;
/// it throws std::runtime_error when HDF5 refuses.
namespace pamr::test {

template <class T>
hid_t hdf5_type() {
  if constexpr (std::is_same_v<T, double>) return H5T_NATIVE_DOUBLE;
  if constexpr (std::is_same_v<T, float>) return H5T_NATIVE_FLOAT;
  if constexpr (std::is_same_v<T, std::int64_t>) return H5T_NATIVE_INT64;
  if constexpr (std::is_same_v<T, std::uint64_t>) return H5T_NATIVE_UINT64;
  if constexpr (std::is_same_v<T, std::int32_t>) return H5T_NATIVE_INT32;
  if constexpr (std::is_same_v<T, std::uint8_t>) return H5T_NATIVE_UINT8;
  if constexpr (std::is_same_v<T, std::int8_t>) return H5T_NATIVE_INT8;
}

using Shape = std::vector<hsize_t>;

/// How a new dataset is stored: `chunk` rows with deflate (0: contiguous), the type in the file (0: as in memory).
struct Storage {
  hsize_t chunk = 0;
  hid_t file_type = 0;
};

void create_file(const std::filesystem::path& file);
void create_group(const std::filesystem::path& file, const std::string& path);
void remove_object(const std::filesystem::path& file, const std::string& path);
bool has_object(const std::filesystem::path& file, const std::string& path);
void make_soft_link(const std::filesystem::path& file, const std::string& target, const std::string& path);

void write_dataset_raw(const std::filesystem::path& file, const std::string& path, const Shape& shape, hid_t type,
                       const void* values, Storage storage);
/// Makes the dataset anew with this shape and these values.
template <class T>
void write_dataset(const std::filesystem::path& file, const std::string& path, const Shape& shape,
                   const std::vector<T>& values, Storage storage = {}) {
  write_dataset_raw(file, path, shape, hdf5_type<T>(), values.data(), storage);
}
/// Lists of texts, as h5py writes them: of variable length.
void write_texts(const std::filesystem::path& file, const std::string& path, const std::vector<std::string>& texts);

void read_dataset_raw(const std::filesystem::path& file, const std::string& path, hid_t type,
                      std::vector<std::byte>& values, std::size_t size);
template <class T>
std::vector<T> read_dataset(const std::filesystem::path& file, const std::string& path) {
  std::vector<std::byte> bytes;
  read_dataset_raw(file, path, hdf5_type<T>(), bytes, sizeof(T));
  std::vector<T> values(bytes.size() / sizeof(T));
  std::copy(bytes.begin(), bytes.end(), reinterpret_cast<std::byte*>(values.data()));
  return values;
}
Shape shape_of(const std::filesystem::path& file, const std::string& path);

/// Changes one value and takes the dataset's entry out of the checksums, as if it had been written that way.
template <class T>
void set_value(const std::filesystem::path& file, const std::string& path, std::size_t index, T value) {
  auto values = read_dataset<T>(file, path);
  values.at(index) = value;
  write_dataset(file, path, shape_of(file, path), values);
}

void remove_attribute(const std::filesystem::path& file, const std::string& path, const std::string& name);
void write_attribute(const std::filesystem::path& file, const std::string& path, const std::string& name,
                     const std::vector<std::int64_t>& values);
void write_attribute(const std::filesystem::path& file, const std::string& path, const std::string& name,
                     const std::string& text);

std::uint64_t read_unsigned_attribute(const std::filesystem::path& file, const std::string& path,
                                      const std::string& name);

/// Where the first byte of a contiguous dataset lies in the file, and how many there are.
struct Extent {
  std::uint64_t offset = 0, bytes = 0;
};
Extent extent_of(const std::filesystem::path& file, const std::string& path);
/// The same of the first chunk of a chunked dataset.
Extent first_chunk_of(const std::filesystem::path& file, const std::string& path);

/// Flips all bits of one byte of the file.
void flip_byte(const std::filesystem::path& file, std::uint64_t offset);
std::string bytes_of(const std::filesystem::path& file);

}  // namespace pamr::test
