// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/slab_reader.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cstring>
#include <type_traits>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/io/native/checksum.hpp"
#include "pamr/io/native/layout.hpp"

namespace pamr::io {

namespace {

using mesh::StorageType;

/// Calls `run` with a value of the C++ type that a storage type stands for.
template <class Run>
void with_type(StorageType type, Run run) {
  switch (type) {
    case StorageType::float64:
      return run(double{});
    case StorageType::float32:
      return run(float{});
    case StorageType::int64:
      return run(std::int64_t{});
    case StorageType::int32:
      return run(std::int32_t{});
    case StorageType::int16:
      return run(std::int16_t{});
    case StorageType::int8:
      return run(std::int8_t{});
    case StorageType::uint64:
      return run(std::uint64_t{});
    case StorageType::uint32:
      return run(std::uint32_t{});
    case StorageType::uint16:
      return run(std::uint16_t{});
    case StorageType::uint8:
      return run(std::uint8_t{});
  }
}

/// Fields are what solvers rewrite, with no thought of checksums.
bool is_field(const std::string& dataset) {
  return dataset.starts_with(std::string(path::point_data) + "/") ||
         dataset.starts_with(std::string(path::cell_data) + "/");
}

/// What is looked at in one go.
constexpr std::size_t values_at_once = std::size_t{2} << 10U;

}  // namespace

SlabReader::SlabReader(const par::Comm& comm, std::filesystem::path file, const Catalog& catalog,
                       const Options& options)
    : comm_(&comm), file_(std::move(file)), catalog_(&catalog), options_(options) {
  options_.slab_bytes = std::min<std::size_t>(options_.slab_bytes, hdf5::max_transfer_bytes);
  par::agree(comm, [&] {
    const par::Comm::Waiting waiting(comm, par::Comm::Waiting::In::library);
    const auto access = hdf5::parallel_access(comm, file_, hdf5::Access::read);
    h5_ = hdf5::take(H5Fopen(file_.c_str(), H5F_ACC_RDONLY, access.id()), H5Fclose,
                     fmt::format("file '{}': cannot open it", file_.string()));
  });
}

SlabReader::~SlabReader() {
  comm_->in_library([&] { return h5_.reset(); });
}

std::string SlabReader::place(const std::string& path) const {
  return fmt::format("file '{}', {}", file_.string(), path);
}

void SlabReader::fail(const std::string& path, GlobalId row, const std::string& expected,
                      const std::string& found) const {
  throw Error(fmt::format("{}, row {}: expected {}, found {}", place(path), row, expected, found));
}

/// HDF5 opens a dataset on all ranks together; reading its rows is each rank's own.
RowSource SlabReader::open_rows(const Dataset& dataset, Rows rows) const {
  const par::Comm::Waiting waiting(*comm_, par::Comm::Waiting::In::library);
  try {
    return {file_, h5_.id(), *catalog_->find_array(dataset.path), dataset.shape, rows.begin};
  } catch (const Error& error) {
    throw Error(fmt::format("{}: {}", place(dataset.path), error.what()));
  }
}

void SlabReader::each_slab(const Dataset& dataset, Rows rows, bool verify, const Consume& consume) {
  const auto& path = dataset.path;  // no structured binding: clang 14 lets no lambda capture one
  const auto type = dataset.type;
  const auto& shape = dataset.shape;
  const auto* stored = catalog_->find_number(std::string(path::checksums) + "@" + checksum_path(path));
  verify = verify && options_.verify_checksums && stored != nullptr;
  Checksum checksum(verify ? shape.rows : 0);
  const auto width = at(shape.width);
  const auto rows_in = [&](std::size_t values) {  // the corners of a cell are four rows of one dataset
    return std::max<GlobalId>(4, static_cast<GlobalId>(values / width / 4 * 4));
  };
  const bool is_chunked = catalog_->find_array(path)->is_chunked;
  const auto slab = rows_in(
      (is_chunked ? options_.slab_bytes : std::min<std::size_t>(options_.slab_bytes, hdf5::cached_piece_bytes)) / 8);
  const auto step = rows_in(values_at_once);
  par::agree(*comm_, [&] {
    auto source = open_rows(dataset, rows);
    for (auto first = rows.begin; first < rows.end; first += slab) {
      const auto n = std::min(slab, rows.end - first);
      const auto bytes = at(n) * width * hdf5::size_of(type);
      raw_.resize((bytes + 7) / 8);
      if (!comm_->in_library([&] { return source.read(n, std::as_writable_bytes(std::span(raw_)).first(bytes)); }))
        throw Error(fmt::format("{}: cannot read rows from {} on ({})", place(path), first, source.trouble()));
      for (GlobalId row = 0; row < n; row += step) {
        const auto words = as_words(type, at(row) * width, at(std::min(step, n - row)) * width);
        if (type == StorageType::uint64)
          for (std::size_t i = 0; i < words.size(); ++i)
            if (words[i] >> 63U != 0)
              fail(path, first + row + static_cast<GlobalId>(i / width), "integers below 2^63",
                   fmt::format("{}", words[i]));
        if (verify) checksum.add(first + row, width, words);
        consume(first + row, words);
      }
    }
  });
  if (!verify) return;
  if (stored->values.size() == 1 && std::bit_cast<std::uint64_t>(stored->values[0]) == checksum.result(*comm_)) return;
  if (!is_field(path))
    throw Error(fmt::format("{}: expected contents that agree with its checksum, found that they do not: {}",
                            place(path), damaged_or_changed(path)));
  if (options_.remark)
    options_.remark(fmt::format("{}: the values do not agree with their checksum: they were changed after it was made",
                                place(path)));
}

/// Values of the slab as 64-bit words: where they lie if that is what they are, else converted.
std::span<const std::uint64_t> SlabReader::as_words(StorageType type, std::size_t first, std::size_t n) {
  if (hdf5::size_of(type) == 8) return std::span(raw_).subspan(first, n);
  words_.resize(std::max(words_.size(), n));
  with_type(type, [&](auto sample) {
    using T = decltype(sample);
    const auto raw = std::as_bytes(std::span(raw_)).subspan(first * sizeof(T), n * sizeof(T));
    for (std::size_t i = 0; i < n; ++i) {
      T value;
      std::memcpy(&value, raw.data() + i * sizeof(T), sizeof(T));
      if constexpr (std::is_floating_point_v<T>)
        words_[i] = std::bit_cast<std::uint64_t>(static_cast<double>(value));
      else
        words_[i] = static_cast<std::uint64_t>(static_cast<std::int64_t>(value));
    }
  });
  return std::span(words_).first(n);
}

}  // namespace pamr::io
