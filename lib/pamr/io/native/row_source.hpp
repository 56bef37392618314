// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>

#include "pamr/base/types.hpp"
#include "pamr/io/native/catalog.hpp"
#include "pamr/io/native/hdf5.hpp"

namespace pamr::io {

/// This rank's rows of a dataset, one slab after another, through the file that all ranks have open.
class RowSource {
 public:
  /// From row `first` on. Collective over the ranks that have `h5` open; throws `Error` without the file's name.
  RowSource(const std::filesystem::path& file, hid_t h5, const ArrayEntry& entry, const hdf5::Shape& shape,
            GlobalId first);

  /// Reads the next `n` rows (1 or more) to where `raw` lies, whose size is theirs.
  /// Local; false when it failed, and `trouble` says why.
  bool read(GlobalId n, std::span<std::byte> raw);
  std::string trouble();

 private:
  /// Why the zeros at the end of what was read, which begins at this byte of the file, are not those of the file; empty
  /// if they are. Open MPI tells of no error when a disk fails or a file has been cut, and HDF5 takes what is missing
  /// for zeros.
  std::string missing(std::uint64_t begin, std::span<const std::byte> raw) const;

  std::filesystem::path file_;
  mesh::StorageType type_;
  hdf5::Shape shape_;
  GlobalId next_;
  hdf5::Handle dataset_, transfer_;
  bool is_chunked_;
  haddr_t place_ = HADDR_UNDEF;  ///< of a contiguous dataset in the file
  std::string short_read_;       ///< why the last read was none
};

}  // namespace pamr::io
