// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/io/native/catalog.hpp"
#include "pamr/io/native/hdf5.hpp"
#include "pamr/io/native/row_source.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Rows `begin .. end` of a dataset.
struct Rows {
  GlobalId begin = 0, end = 0;
  GlobalId count() const { return end - begin; }
};

/// A dataset of numbers as its layout says.
struct Dataset {
  std::string path;
  mesh::StorageType type = mesh::StorageType::float64;
  hdf5::Shape shape;
};

/// Reads the datasets of a native file piece by piece, so that no copy of a dataset is ever held.
class SlabReader {
 public:
  struct Options {
    bool verify_checksums = true;
    std::size_t slab_bytes = 0;                      ///< largest piece that is read at once
    std::function<void(const std::string&)> remark;  ///< see `ReadOptions`
  };

  /// Opens the file on all ranks. `catalog`: of the file, outlives the reader. Collective; throws `Error`.
  SlabReader(const par::Comm& comm, std::filesystem::path file, const Catalog& catalog, const Options& options);
  ~SlabReader();
  SlabReader(const SlabReader&) = delete;
  SlabReader& operator=(const SlabReader&) = delete;
  SlabReader(SlabReader&&) = delete;
  SlabReader& operator=(SlabReader&&) = delete;

  const par::Comm& comm() const { return *comm_; }

  /// Receives the words of whole rows, the first of which has the number given. May throw `Error`.
  using Consume = std::function<void(GlobalId first_row, std::span<const std::uint64_t> words)>;

  /// Reads this rank's rows and hands them on as 64-bit words (integers sign-extended, reals as doubles), whole groups
  /// of four rows where there are so many. With `verify` the rows of all ranks together are the whole dataset, once,
  /// and are compared with its checksum; one that does not fit is an error, of a field a remark. Collective; throws the
  /// same `Error` on every rank.
  void each_slab(const Dataset& dataset, Rows rows, bool verify, const Consume& consume);

  /// Throws `Error`: what was expected in a row of a dataset, and what was found.
  [[noreturn]] void fail(const std::string& path, GlobalId row, const std::string& expected,
                         const std::string& found) const;

 private:
  RowSource open_rows(const Dataset& dataset, Rows rows) const;
  std::span<const std::uint64_t> as_words(mesh::StorageType type, std::size_t first, std::size_t n);
  std::string place(const std::string& path) const;

  const par::Comm* comm_;
  std::filesystem::path file_;
  const Catalog* catalog_;
  Options options_;
  hdf5::Handle h5_;
  std::vector<std::uint64_t> raw_;    ///< a slab as the file has it, at the front, and
  std::vector<std::uint64_t> words_;  ///< a part of it as words; memory is taken once for all datasets
};

}  // namespace pamr::io
