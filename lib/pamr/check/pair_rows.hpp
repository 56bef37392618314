// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/par/comm.hpp"

namespace pamr::check {

/// How one column of a row is compared.
enum class Column : std::uint8_t {
  exact,    ///< equal bits
  real,     ///< double: the tolerance times max(1, |a|, |b|); two values that are no numbers are equal
  integer,  ///< 64-bit integer: the tolerance as it is
};

/// Things to be paired with those of another mesh: rows of `n_keys` words that name the thing, one word that is its
/// number in its own mesh, and one word for each column.
struct Rows {
  std::size_t n_keys = 1;
  std::vector<std::uint64_t> word;
};

/// How often something differs over all ranks, the smallest number (in the first mesh where the thing is in it) where
/// it does, and the largest difference of numbers.
struct Tally {
  std::int64_t count = 0;
  GlobalId first = invalid_global;
  double largest = 0;
};

struct Pairing {
  Tally only_in_a, only_in_b;
  std::vector<Tally> column;
};

/// Pairs the rows of two meshes that have the same key and compares their columns. Where several rows of a mesh share
/// a key, they are paired in the order of their columns. Rows may lie on any
/// rank; a row that several ranks give counts once.
/// Collective: two sparse exchanges that carry all rows, and reductions. O(rows log rows).
Pairing pair_rows(const par::Comm& comm, const Rows& a, const Rows& b, std::span<const Column> columns,
                  double tolerance);

}  // namespace pamr::check
