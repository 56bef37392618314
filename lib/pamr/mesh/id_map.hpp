// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <vector>

#include "pamr/base/types.hpp"

namespace pamr::mesh {

/// Global to local numbers. A plain table where the numbers lie close together (at most `4 * expected` apart), a hash
/// table with open addressing elsewhere, so that memory follows the numbers stored and not the size of the whole mesh.
class IdMap {
 public:
  /// Takes numbers from `min` to `max`; `expected` says how many to make room for.
  IdMap(GlobalId min, GlobalId max, std::size_t expected);

  /// The local number, or `invalid_local`.
  LocalId find(GlobalId id) const;
  /// The local number of `id`, which becomes `next` when there is none yet.
  LocalId find_or_insert(GlobalId id, LocalId next);

 private:
  struct Entry {
    GlobalId id = invalid_global;
    LocalId local = invalid_local;
  };
  std::size_t place_of(GlobalId id) const;
  void make_hash(std::size_t n);
  void grow();

  GlobalId min_ = 0;
  std::vector<LocalId> table_;
  std::vector<Entry> hash_;  ///< 2^(64 - shift_)
  unsigned shift_ = 0;
  std::size_t n_hashed_ = 0;
};

}  // namespace pamr::mesh
