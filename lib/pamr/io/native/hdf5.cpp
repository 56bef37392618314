// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/hdf5.hpp"

#include <fmt/format.h>
#include <semaphore.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdlib>
#include <new>
#include <string_view>

#include "pamr/base/error.hpp"
#include "pamr/par/mpi_memory.hpp"

namespace pamr::io::hdf5 {

namespace {

herr_t append_description(unsigned /*depth*/, const H5E_error2_t* error, void* text) {
  auto& result = *static_cast<std::string*>(text);
  if (error->desc == nullptr || result.size() > 300) return 0;
  if (!result.empty()) result += "; ";
  for (const char* c = error->desc; *c != '\0'; ++c)
    result += *c < ' ' && *c >= '\0' ? ' ' : *c;  // it has times in lines
  return 0;
}

struct Selection {
  Handle memory, file;
};

Selection select(hid_t dataset, const Shape& shape, std::int64_t first, std::int64_t n) {
  const int rank = shape.is_flat ? 1 : 2;
  const std::array<hsize_t, 2> start{static_cast<hsize_t>(first), 0};
  const std::array<hsize_t, 2> count{static_cast<hsize_t>(n), static_cast<hsize_t>(shape.width)};
  Selection result{Handle(H5Screate_simple(rank, count.data(), nullptr), H5Sclose),
                   Handle(H5Dget_space(dataset), H5Sclose)};
  if (n == 0) {
    H5Sselect_none(result.memory.id());
    H5Sselect_none(result.file.id());
  } else {
    H5Sselect_hyperslab(result.file.id(), H5S_SELECT_SET, start.data(), nullptr, count.data(), nullptr);
  }
  return result;
}

/// For the shared file pointer of each file, which HDF5 never uses, Open MPI 4.1 makes a semaphore that is named after
/// the file alone. A process that is killed at the wrong moment leaves it locked, and whoever opens a file of that name
/// later, in any folder, would wait for ever. Without a name it harms nobody.
void forget_semaphore_of(const std::filesystem::path& file) {
  sem_unlink(("/OMPIO_" + file.filename().string()).c_str());
}

/// The component that stands in where there is no shared memory overruns a buffer when it is asked about a path of more
/// than 250 characters. Open MPI looks at this when the first file is opened.
void leave_out_locked_files() {
  setenv("OMPI_MCA_sharedfp", "^lockedfile", 0);  // NOLINT(concurrency-mt-unsafe): as MPI, called by one thread
}

}  // namespace

Silence::Silence() {
  H5Eget_auto2(H5E_DEFAULT, &print_, &data_);
  H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
}

Silence::~Silence() { H5Eset_auto2(H5E_DEFAULT, print_, data_); }

std::string last_error() {
  std::string text;
  H5Ewalk2(H5E_DEFAULT, H5E_WALK_UPWARD, append_description, &text);
  H5Eclear2(H5E_DEFAULT);
  // A message of the system says why a call failed; the rest names functions of HDF5 and temporary files.
  constexpr std::string_view mark = "error message = '";
  if (const auto at = text.find(mark); at != std::string::npos) {
    const auto begin = at + mark.size();
    return text.substr(begin, text.find('\'', begin) - begin);
  }
  return text.empty() ? "no reason given" : text;
}

Handle take(hid_t id, Handle::Close close, const std::string& what) {
  require(id >= 0, what);
  return {id, close};
}

void require(bool succeeded, const std::string& what) {
  if (!succeeded) throw Error(what + " (HDF5: " + last_error() + ")");
}

hid_t memory_type(mesh::StorageType type) {
  switch (type) {
    case mesh::StorageType::float64:
      return H5T_NATIVE_DOUBLE;
    case mesh::StorageType::float32:
      return H5T_NATIVE_FLOAT;
    case mesh::StorageType::int64:
      return H5T_NATIVE_INT64;
    case mesh::StorageType::int32:
      return H5T_NATIVE_INT32;
    case mesh::StorageType::int16:
      return H5T_NATIVE_INT16;
    case mesh::StorageType::int8:
      return H5T_NATIVE_INT8;
    case mesh::StorageType::uint64:
      return H5T_NATIVE_UINT64;
    case mesh::StorageType::uint32:
      return H5T_NATIVE_UINT32;
    case mesh::StorageType::uint16:
      return H5T_NATIVE_UINT16;
    case mesh::StorageType::uint8:
      return H5T_NATIVE_UINT8;
  }
  return -1;
}

hid_t file_type(mesh::StorageType type) {
  switch (type) {
    case mesh::StorageType::float64:
      return H5T_IEEE_F64LE;
    case mesh::StorageType::float32:
      return H5T_IEEE_F32LE;
    case mesh::StorageType::int64:
      return H5T_STD_I64LE;
    case mesh::StorageType::int32:
      return H5T_STD_I32LE;
    case mesh::StorageType::int16:
      return H5T_STD_I16LE;
    case mesh::StorageType::int8:
      return H5T_STD_I8LE;
    case mesh::StorageType::uint64:
      return H5T_STD_U64LE;
    case mesh::StorageType::uint32:
      return H5T_STD_U32LE;
    case mesh::StorageType::uint16:
      return H5T_STD_U16LE;
    case mesh::StorageType::uint8:
      return H5T_STD_U8LE;
  }
  return -1;
}

std::size_t size_of(mesh::StorageType type) {
  switch (type) {
    case mesh::StorageType::float64:
    case mesh::StorageType::int64:
    case mesh::StorageType::uint64:
      return 8;
    case mesh::StorageType::float32:
    case mesh::StorageType::int32:
    case mesh::StorageType::uint32:
      return 4;
    case mesh::StorageType::int16:
    case mesh::StorageType::uint16:
      return 2;
    case mesh::StorageType::int8:
    case mesh::StorageType::uint8:
      return 1;
  }
  return 0;
}

std::string to_text(mesh::StorageType type) {
  if (!mesh::is_integer(type)) return fmt::format("float{}", 8 * size_of(type));
  const bool is_unsigned = type == mesh::StorageType::uint64 || type == mesh::StorageType::uint32 ||
                           type == mesh::StorageType::uint16 || type == mesh::StorageType::uint8;
  return fmt::format("{}{}", is_unsigned ? "uint" : "int", 8 * size_of(type));
}

Handle parallel_access(const par::Comm& comm, const std::filesystem::path& file, Access purpose) {
  if (!par::has_mpi_memory(comm.size())) throw std::bad_alloc();
  leave_out_locked_files();
  forget_semaphore_of(file);
  auto access = take(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "cannot make a property list");
  require(H5Pset_fapl_mpio(access.id(), comm.handle(), MPI_INFO_NULL) >= 0 &&
              H5Pset_all_coll_metadata_ops(access.id(), true) >= 0 &&
              H5Pset_coll_metadata_write(access.id(), false) >= 0 &&
              (purpose == Access::read || H5Pset_libver_bounds(access.id(), H5F_LIBVER_V18, H5F_LIBVER_V18) >= 0),
          "cannot select parallel file access");
  return access;
}

Handle independent_transfer() {
  auto transfer = take(H5Pcreate(H5P_DATASET_XFER), H5Pclose, "cannot make a property list");
  require(H5Pset_dxpl_mpio(transfer.id(), H5FD_MPIO_INDEPENDENT) >= 0, "cannot select independent transfers");
  return transfer;
}

namespace {

/// Calls `transfer_piece(file, memory, offset in bytes)` for pieces of the rows that fit MPI's counts, at least once,
/// until one fails.
template <class TransferPiece>
bool transfer_in_pieces(const Slab& slab, std::size_t bytes_of_value, TransferPiece&& transfer_piece) {
  const auto bytes_of_row = static_cast<std::size_t>(slab.shape.width) * bytes_of_value;
  const auto at_once = std::max<std::int64_t>(1, static_cast<std::int64_t>(max_transfer_bytes / bytes_of_row));
  std::int64_t done = 0;
  do {
    const auto piece = std::min(at_once, slab.n - done);
    const auto selection = select(slab.dataset, slab.shape, slab.first + done, piece);
    if (!transfer_piece(selection.file.id(), selection.memory.id(), static_cast<std::size_t>(done) * bytes_of_row))
      return false;
    done += piece;
  } while (done < slab.n);
  return true;
}

}  // namespace

bool read_rows(const Slab& slab, mesh::StorageType type, void* to, hid_t transfer) {
  return transfer_in_pieces(slab, size_of(type), [&](hid_t file, hid_t memory, std::size_t offset) {
    return H5Dread(slab.dataset, memory_type(type), memory, file, transfer, static_cast<std::byte*>(to) + offset) >= 0;
  });
}

bool write_rows(const Slab& slab, hid_t type, const void* from, hid_t transfer) {
  return transfer_in_pieces(slab, H5Tget_size(type), [&](hid_t file, hid_t memory, std::size_t offset) {
    return H5Dwrite(slab.dataset, type, memory, file, transfer, static_cast<const std::byte*>(from) + offset) >= 0;
  });
}

}  // namespace pamr::io::hdf5
