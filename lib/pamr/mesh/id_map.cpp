// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/id_map.hpp"

#include <algorithm>
#include <bit>
#include <utility>

namespace pamr::mesh {

IdMap::IdMap(GlobalId min, GlobalId max, std::size_t expected) : min_(min) {
  const auto range = static_cast<std::uint64_t>(max) - static_cast<std::uint64_t>(min);
  if (range < 4 * std::max<std::size_t>(expected, 16))
    table_.assign(static_cast<std::size_t>(range) + 1, invalid_local);
  else
    make_hash(std::bit_ceil(2 * std::max<std::size_t>(expected, 16)));
}

void IdMap::make_hash(std::size_t n) {
  hash_.assign(n, {});
  shift_ = 64U - static_cast<unsigned>(std::countr_zero(n));
}

/// Eight consecutive numbers stand in one place, because they are asked for together.
std::size_t IdMap::place_of(GlobalId id) const {
  const auto bits = static_cast<std::uint64_t>(id);
  auto place =
      static_cast<std::size_t>(((bits >> 3U) * 0x9e3779b97f4a7c15U >> shift_ & ~std::uint64_t{7}) | (bits & 7U));
  while (hash_[place].id != id && hash_[place].id != invalid_global) place = (place + 1) & (hash_.size() - 1);
  return place;
}

LocalId IdMap::find(GlobalId id) const {
  if (!hash_.empty()) return hash_[place_of(id)].local;
  const auto at = static_cast<std::uint64_t>(id) - static_cast<std::uint64_t>(min_);
  return at < table_.size() ? table_[static_cast<std::size_t>(at)] : invalid_local;
}

LocalId IdMap::find_or_insert(GlobalId id, LocalId next) {
  if (hash_.empty()) {
    auto& local = table_[static_cast<std::size_t>(id - min_)];
    if (local == invalid_local) local = next;
    return local;
  }
  auto& entry = hash_[place_of(id)];
  if (entry.id == id) return entry.local;
  entry = {id, next};
  if (2 * ++n_hashed_ > hash_.size()) grow();
  return next;
}

void IdMap::grow() {
  const auto old = std::exchange(hash_, {});
  make_hash(2 * old.size());
  for (const auto& entry : old)
    if (entry.id != invalid_global) hash_[place_of(entry.id)] = entry;
}

}  // namespace pamr::mesh
