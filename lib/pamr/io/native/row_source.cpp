// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/row_source.hpp"

#include <algorithm>

#include "pamr/base/error.hpp"

namespace pamr::io {

namespace {

/// A processor inflates and sends at least so many bytes a second.
constexpr rlim_t slowest = rlim_t{4} << 20U;

std::size_t n_bytes(const hdf5::Shape& shape, mesh::StorageType type, GlobalId n) {
  return static_cast<std::size_t>(n * shape.width) * hdf5::size_of(type);
}

/// In the process of its own: reads the rows with HDF5's serial driver and sends them.
void read_alone(const std::filesystem::path& file, const ArrayEntry& entry, const hdf5::Shape& shape, GlobalId first,
                GlobalId end, GlobalId slab, const Subprocess::Send& send) {
  const auto access = hdf5::take(H5Pcreate(H5P_FILE_ACCESS), H5Pclose, "");
  H5Pset_file_locking(access.id(), true, true);
  const auto h5 = hdf5::take(H5Fopen(file.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose, "");
  const auto dataset = hdf5::take(H5Dopen2(h5.id(), entry.path.c_str(), H5P_DEFAULT), H5Dclose, "");
  std::vector<char> raw;
  for (; first < end; first += slab) {
    const auto n = std::min(slab, end - first);
    raw.resize(n_bytes(shape, entry.type, n));
    hdf5::require(hdf5::read_rows(dataset.id(), shape, first, n, entry.type, raw.data(), H5P_DEFAULT), "");
    send(raw);
  }
}

}  // namespace

RowSource::RowSource(const std::filesystem::path& file, hid_t h5, const ArrayEntry& entry, const hdf5::Shape& shape,
                     GlobalId first, GlobalId end, GlobalId slab)
    : type_(entry.type), shape_(shape), next_(first) {
  if (!entry.is_chunked || !may_fork()) {
    dataset_ = hdf5::take(H5Dopen2(h5, entry.path.c_str(), H5P_DEFAULT), H5Dclose, "cannot open it");
    transfer_ = hdf5::independent_transfer();
    return;
  }
  if (first >= end) return;
  process_.emplace([&](const Subprocess::Send& send) { read_alone(file, entry, shape, first, end, slab, send); },
                   Subprocess::Limits{.processor_seconds = 2 + n_bytes(shape, entry.type, end - first) / slowest,
                                      .memory_bytes = Subprocess::memory_for(std::filesystem::file_size(file))});
}

bool RowSource::read(GlobalId n, std::span<std::byte> raw) {
  const auto first = next_;
  next_ += n;
  if (dataset_.is_open()) return hdf5::read_rows(dataset_.id(), shape_, first, n, type_, raw.data(), transfer_.id());
  return process_->receive({reinterpret_cast<char*>(raw.data()), raw.size()});
}

std::string RowSource::trouble() {
  if (!process_) return "HDF5: " + hdf5::last_error();
  const auto reason = process_->end();
  return "expected sound chunks, found some that HDF5 cannot read: " + (reason.empty() ? "too short" : reason);
}

}  // namespace pamr::io
