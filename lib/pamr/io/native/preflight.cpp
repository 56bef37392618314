// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/preflight.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstddef>
#include <cstring>
#include <fstream>
#include <new>
#include <string>
#include <system_error>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/io/elements/first_line.hpp"
#include "pamr/io/formats.hpp"
#include "pamr/io/native/hdf5.hpp"
#include "pamr/io/native/inspect.hpp"

namespace pamr::io {

namespace {

void require_regular_file(const std::filesystem::path& file) {
  std::error_code code;
  const auto status = std::filesystem::status(file, code);
  if (!std::filesystem::exists(status))
    throw Error(fmt::format("file '{}': expected a file, found none", file.string()));
  if (!std::filesystem::is_regular_file(status))
    throw Error(fmt::format("file '{}': expected a file, found {}", file.string(),
                            std::filesystem::is_directory(status) ? "a folder" : "something else"));
  if (access(file.c_str(), R_OK) != 0)
    throw Error(
        fmt::format("file '{}': expected a file that may be read, found: {}", file.string(), std::strerror(errno)));
}

void require_signature(const std::filesystem::path& file) {
  if (has_hdf5_signature(file)) return;
  std::ifstream stream(file, std::ios::binary);
  if (!stream)
    throw Error(
        fmt::format("file '{}': expected a file that can be opened, found: {}", file.string(), std::strerror(errno)));
  const std::string gmsh = "$MeshFormat";
  std::string begin(gmsh.size(), '\0');
  stream.read(begin.data(), static_cast<std::streamsize>(begin.size()));
  const auto* format = begin == gmsh ? find_format("mesh.msh") : find_format(file);
  if (format != nullptr && format->read != nullptr && !format->is_native)
    throw Error(fmt::format("file '{0}': expected an HDF5 file, found one of {1}: pamr-convert {0} {2}", file.string(),
                            format->name, std::filesystem::path(file).replace_extension(".hdf").string()));
  const auto what = what_begins(file);
  throw Error(fmt::format("file '{}': expected an HDF5 file, found {}", file.string(),
                          what.empty() ? "no HDF5 signature" : what));
}

/// Memory that there is not for what a damaged file claims is the fault of the file.
Catalog inspect_within_memory(const std::filesystem::path& file) {
  try {
    return inspect(file);
  } catch (const std::bad_alloc&) {
    throw Error(
        fmt::format("file '{}': expected contents in keeping with its size, found a claim of more, or no memory "
                    "to look at them",
                    file.string()));
  }
}

/// Reads all rows of a dataset in pieces, with HDF5's serial driver.
void try_rows(const std::string& place, hid_t file, const ArrayEntry& entry, const hdf5::Shape& shape) {
  constexpr std::int64_t piece = std::int64_t{16} << 20U;
  const auto dataset = hdf5::take(H5Dopen2(file, entry.path.c_str(), H5P_DEFAULT), H5Dclose, place);
  const auto bytes_of_row = shape.width * static_cast<std::int64_t>(hdf5::size_of(entry.type));
  const auto n = std::clamp<std::int64_t>(piece / bytes_of_row, 1, shape.rows);
  std::vector<std::byte> raw(static_cast<std::size_t>(n * bytes_of_row));
  for (std::int64_t first = 0; first < shape.rows; first += n)
    hdf5::require(hdf5::read_rows({dataset.id(), shape, first, std::min(n, shape.rows - first)}, entry.type, raw.data(),
                                  H5P_DEFAULT),
                  place + ": expected sound chunks, found some that HDF5 cannot read");
}

}  // namespace

bool has_hdf5_signature(const std::filesystem::path& file) {
  constexpr std::array<char, 8> signature{'\x89', 'H', 'D', 'F', '\r', '\n', '\x1a', '\n'};
  std::error_code failed;
  const auto bytes = std::filesystem::file_size(file, failed);
  std::ifstream stream(file, std::ios::binary);
  for (std::uintmax_t offset = 0; !failed && stream && offset + 8 <= bytes; offset = offset == 0 ? 512 : 2 * offset) {
    std::array<char, 8> found{};
    stream.seekg(static_cast<std::streamoff>(offset));
    if (stream.read(found.data(), found.size()) && found == signature) return true;
  }
  return false;
}

Catalog catalog_of(const par::Comm& comm, const std::filesystem::path& file) {
  std::string packed;
  Catalog catalog;
  par::agree(comm, [&] {
    if (!comm.is_first()) return;
    require_regular_file(file);
    require_signature(file);
    catalog = inspect_within_memory(file);
    packed = pack(catalog);
  });
  packed = comm.broadcast(std::move(packed));
  if (!comm.is_first()) catalog = unpack(packed);
  return catalog;
}

void try_reading(const std::filesystem::path& file, const std::function<void(std::uint64_t bytes)>& before_dataset) {
  const auto catalog = inspect_within_memory(file);
  const hdf5::Silence silence;
  const auto access = hdf5::take(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, file.string());
  H5Pset_file_locking(access.id(), true, true);
  const auto h5 = hdf5::take(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose, file.string());
  for (const auto& entry : catalog.arrays) {
    const bool is_flat = entry.shape.size() == 1;
    const hdf5::Shape shape{entry.shape[0], is_flat ? 1 : entry.shape[1], is_flat};
    const auto bytes = static_cast<std::uint64_t>(shape.rows * shape.width) * hdf5::size_of(entry.type);
    if (!entry.is_chunked || bytes == 0) continue;
    before_dataset(bytes);
    try_rows(fmt::format("file '{}', {}", file.string(), entry.path), h5.id(), entry, shape);
  }
}

}  // namespace pamr::io
