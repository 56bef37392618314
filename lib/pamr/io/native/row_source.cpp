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

/// A processor inflates and sends at least so many bytes a second.
constexpr rlim_t slowest = rlim_t{4} << 20U;

std::size_t n_bytes(const hdf5::Shape& shape, mesh::StorageType type, GlobalId n) {
  return static_cast<std::size_t>(n * shape.width) * hdf5::size_of(type);
}

/// In the process of its own: reads the rows with HDF5's serial driver and sends them.
void read_alone(const std::filesystem::path& file, const ArrayEntry& entry, const hdf5::Shape& shape,
                const RowSource::Slabs& rows, const Subprocess::Send& send) {
  const auto access = hdf5::take(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "");
  H5Pset_file_locking(access.id(), true, true);
  const auto h5 = hdf5::take(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose, "");
  const auto dataset = hdf5::take(H5Dopen2(h5.id(), entry.path.c_str(), H5P_DEFAULT), H5Dclose, "");
  std::vector<char> raw;
  for (auto first = rows.first; first < rows.end; first += rows.slab) {
    const auto n = std::min(rows.slab, rows.end - first);
    raw.resize(n_bytes(shape, entry.type, n));
    hdf5::require(hdf5::read_rows({dataset.id(), shape, first, n}, entry.type, raw.data(), H5P_DEFAULT), "");
    send(raw);
  }
}

}  // namespace

RowSource::RowSource(const std::filesystem::path& file, hid_t h5, const ArrayEntry& entry, const hdf5::Shape& shape,
                     const Slabs& rows)
    : file_(file), type_(entry.type), shape_(shape), next_(rows.first) {
  if (!entry.is_chunked || !may_fork()) {
    dataset_ = hdf5::take(H5Dopen2(h5, entry.path.c_str(), H5P_DEFAULT), H5Dclose, "cannot open it");
    transfer_ = hdf5::independent_transfer();
    if (!entry.is_chunked) place_ = H5Dget_offset(dataset_.id());
    return;
  }
  if (rows.first >= rows.end) return;
  process_.emplace(
      [&](const Subprocess::Send& send) { read_alone(file, entry, shape, rows, send); },
      Subprocess::Limits{.processor_seconds = 2 + n_bytes(shape, entry.type, rows.end - rows.first) / slowest,
                         .memory_bytes = Subprocess::memory_for(std::filesystem::file_size(file))});
}

bool RowSource::read(GlobalId n, std::span<std::byte> raw) {
  const auto first = next_;
  next_ += n;
  if (dataset_.is_open()) {
    if (!hdf5::read_rows({dataset_.id(), shape_, first, n}, type_, raw.data(), transfer_.id())) return false;
    short_read_ = place_ == HADDR_UNDEF ? "" : missing(place_ + n_bytes(shape_, type_, first), raw);
    return short_read_.empty();
  }
  return process_->receive({reinterpret_cast<char*>(raw.data()), raw.size()});
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
  if (!process_) return "HDF5: " + hdf5::last_error();
  const auto reason = process_->end();
  return "expected sound chunks, found some that HDF5 cannot read: " + (reason.empty() ? "too short" : reason);
}

}  // namespace pamr::io
