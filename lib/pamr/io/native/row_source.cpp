// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/row_source.hpp"

#include <fcntl.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "pamr/base/error.hpp"

namespace pamr::io {

namespace {

std::size_t n_bytes(const hdf5::Shape& shape, mesh::StorageType type, GlobalId n) {
  return static_cast<std::size_t>(n * shape.width) * hdf5::size_of(type);
}

}  // namespace

RowSource::RowSource(const std::filesystem::path& file, hid_t h5, const ArrayEntry& entry, const hdf5::Shape& shape,
                     GlobalId first)
    : file_(file),
      type_(entry.type),
      shape_(shape),
      next_(first),
      dataset_(hdf5::take(H5Dopen2(h5, entry.path.c_str(), H5P_DEFAULT), H5Dclose, "cannot open it")),
      transfer_(hdf5::independent_transfer()),
      is_chunked_(entry.is_chunked),
      place_(is_chunked_ ? HADDR_UNDEF : H5Dget_offset(dataset_.id())) {}

bool RowSource::read(GlobalId n, std::span<std::byte> raw) {
  const auto first = next_;
  next_ += n;
  if (!hdf5::read_rows({dataset_.id(), shape_, first, n}, type_, raw.data(), transfer_.id())) return false;
  short_read_ = place_ == HADDR_UNDEF ? "" : missing(place_ + n_bytes(shape_, type_, first), raw);
  return short_read_.empty();
}

std::string RowSource::missing(std::uint64_t begin, std::span<const std::byte> raw) const {
  const auto last = std::find_if(raw.rbegin(), raw.rend(), [](std::byte byte) { return byte != std::byte{0}; });
  const auto size = hdf5::size_of(type_);
  const auto n_zeros = static_cast<std::size_t>(last - raw.rbegin()) / size * size;
  if (n_zeros == 0) return {};
  const int file = open(file_.c_str(), O_RDONLY | O_CLOEXEC);
  if (file < 0) return std::strerror(errno);
  std::vector<std::byte> stored(n_zeros);
  std::size_t done = 0;
  ssize_t n = 1;
  while (done < n_zeros && n > 0) {
    n = pread(file, stored.data() + done, n_zeros - done, static_cast<off_t>(begin + raw.size() - n_zeros + done));
    if (n > 0) done += static_cast<std::size_t>(n);
  }
  const std::string reason = n < 0 ? std::strerror(errno) : "";
  close(file);
  if (n < 0) return reason;
  if (done < n_zeros) return "the file has become shorter";
  const bool are_zeros = std::all_of(stored.begin(), stored.end(), [](std::byte byte) { return byte == std::byte{0}; });
  return are_zeros ? "" : "a part was not read";
}

std::string RowSource::trouble() {
  if (!short_read_.empty()) return short_read_;
  return (is_chunked_ ? "expected sound chunks, found some that HDF5 cannot read: " : "HDF5: ") + hdf5::last_error();
}

}  // namespace pamr::io
