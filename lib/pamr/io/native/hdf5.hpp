// SPDX-License-Identifier: GPL-3.0-or-later
// A thin layer over the C interface of HDF5: handles that close themselves, error texts, typed slabs.
#pragma once

#include <hdf5.h>

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pamr/mesh/field.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io::hdf5 {

/// Owns one HDF5 identifier, closed with the function given.
class Handle {
 public:
  using Close = herr_t (*)(hid_t);

  Handle() = default;
  Handle(hid_t id, Close close) : id_(id), close_(close) {}
  ~Handle() { reset(); }
  Handle(const Handle&) = delete;
  Handle& operator=(const Handle&) = delete;
  Handle(Handle&& other) noexcept : id_(std::exchange(other.id_, -1)), close_(other.close_) {}
  Handle& operator=(Handle&& other) noexcept {
    reset();
    id_ = std::exchange(other.id_, -1);
    close_ = other.close_;
    return *this;
  }

  hid_t id() const { return id_; }
  bool is_open() const { return id_ >= 0; }
  /// Closes now; false when HDF5 could not.
  bool reset() noexcept { return !is_open() || close_(std::exchange(id_, -1)) >= 0; }

 private:
  hid_t id_ = -1;
  Close close_ = nullptr;
};

/// Keeps HDF5 from printing errors while it lives.
class Silence {
 public:
  Silence();
  ~Silence();
  Silence(const Silence&) = delete;
  Silence& operator=(const Silence&) = delete;
  Silence(Silence&&) = delete;
  Silence& operator=(Silence&&) = delete;

 private:
  H5E_auto2_t print_ = nullptr;
  void* data_ = nullptr;
};

/// What HDF5 says about its last failure, innermost first; clears it.
std::string last_error();

/// Takes an identifier that HDF5 just returned; throws `Error` with `what` and HDF5's reason when it is not one.
Handle take(hid_t id, Handle::Close close, const std::string& what);
/// Throws `Error` with `what` and HDF5's reason when a call failed.
void require(bool succeeded, const std::string& what);

/// Type of a value in memory and, little endian, in the file.
hid_t memory_type(mesh::StorageType type);
hid_t file_type(mesh::StorageType type);
std::size_t size_of(mesh::StorageType type);
std::string to_text(mesh::StorageType type);

/// The most that is read or written at once: more would not fit MPI's counts.
inline constexpr std::size_t max_transfer_bytes = std::size_t{1} << 30U;
/// What is read or written at once of a dataset that HDF5 need not inflate, and is then looked at in one go: such
/// pieces stay in the processor's caches, and take little memory of their own.
inline constexpr std::size_t cached_piece_bytes = std::size_t{256} << 10U;

/// Extents of a dataset of one or two dimensions: `width` is 1 for one dimension.
struct Shape {
  std::int64_t rows = 0;
  std::int64_t width = 1;
  bool is_flat = true;  ///< one dimension
};

/// Property lists of the parallel driver, for access to a file and for transfers of rows. A file to write has the format
/// that HDF5 1.8 reads, one to read may have any that this library knows. Each rank writes by itself:
/// its rows are one large piece of the file, and a collective transfer of Open MPI 4.1 takes 32 MiB more and waits for
/// ever when one rank runs out of memory in it.
enum class Access : std::uint8_t { read, write };
Handle parallel_access(const par::Comm& comm, const std::filesystem::path& file, Access purpose);
Handle independent_transfer();

/// Rows `first .. first + n` of a dataset; `n` may be 0.
struct Slab {
  hid_t dataset = -1;
  Shape shape;  ///< of the whole dataset
  std::int64_t first = 0, n = 0;
};

/// Reads rows into memory of the given type. Collective unless `transfer` is independent, and then of
/// `max_transfer_bytes` at most; else more goes in pieces.
bool read_rows(const Slab& slab, mesh::StorageType type, void* to, hid_t transfer);
/// Writes rows. As `read_rows`.
bool write_rows(const Slab& slab, hid_t type, const void* from, hid_t transfer);

}  // namespace pamr::io::hdf5
