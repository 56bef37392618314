// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pamr/base/hash.hpp"
#include "pamr/base/types.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Checksum of a dataset of `n_rows` rows that ranks may hold in any pieces. A row's hash takes in its number and its
/// values as 64-bit words (integers sign-extended, reals by the bits of their double); the hash of a block of 65,536
/// rows is the sum of its rows' modulo 2^64; the dataset's chains the blocks in order. See docs/file-format-checksums.md.
class Checksum {
 public:
  static constexpr GlobalId block_rows = 65536;

  explicit Checksum(GlobalId n_rows)
      : n_rows_(n_rows), block_(static_cast<std::size_t>((n_rows + block_rows - 1) / block_rows), 0) {}

  /// Takes in rows `first_row ..` of `width` words each. Local.
  void add(GlobalId first_row, std::size_t width, std::span<const std::uint64_t> words);
  /// The dataset's checksum, after every row was added on exactly one rank. Collective: one reduction of 8 bytes a
  /// block.
  std::uint64_t result(const par::Comm& comm) const;
  /// The same for several datasets, in one reduction for all of them. Collective.
  static std::vector<std::uint64_t> results(const par::Comm& comm, std::span<const Checksum> checksums);

 private:
  GlobalId n_rows_;
  std::vector<std::uint64_t> block_;
};

/// Checksum of a list of texts: each is a row made of its length in bytes and its bytes, one word each. Local.
std::uint64_t checksum_of(std::span<const std::string> texts);

}  // namespace pamr::io
