// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/particles.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <limits>

#include "pamr/base/contract.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/base/prefetch.hpp"
#include "solvers/dsmc/kernel/rank_few.hpp"

namespace pamr::dsmc {

namespace {

/// So many rows before their turn they are fetched from memory. An eighth of it gains half as much.
constexpr std::size_t rows_ahead = 512;

constexpr std::size_t with_room(std::size_t n) { return n + std::max<std::size_t>(1024, n / 16); }

/// Resizes an array whose contents do not matter; a vector left to itself would double.
template <class T>
void remake(std::vector<T>& rows, std::size_t n) {
  if (rows.capacity() < n) {
    rows = {};
    reserve_array(rows, with_room(n));
  }
  rows.resize(n);
}

/// to[i] = rows[order[i]]; `to` may be where `order` is. Rows are fetched early, since those of particles that came
/// from other cells follow no pattern that the processor would foresee.
template <class From, class To>
void take(const std::vector<From>& rows, std::span<const std::uint32_t> order, std::vector<To>& to) {
  const auto n = order.size(), n_fetched = n - std::min(n, rows_ahead);
  std::size_t i = 0;
  for (; i < n_fetched; ++i) {
    prefetch(&rows[order[i + rows_ahead]]);
    to[i] = static_cast<To>(rows[order[i]]);
  }
  for (; i < n; ++i) to[i] = static_cast<To>(rows[order[i]]);
}

/// Rows `order` of `rows`, in that order, through `spare`.
void gather(std::vector<double>& rows, std::vector<double>& spare, std::span<const std::uint32_t> order) {
  remake(spare, order.size());
  take(rows, order, spare);
  rows.swap(spare);
}

}  // namespace

std::size_t Particles::capacity() const {
  std::size_t least = id.capacity();
  for (const auto* values : {&x, &y, &z, &u, &v, &w, &rotation}) least = std::min(least, values->capacity());
  if (vibrate_) least = std::min(least, levels.capacity());
  return std::min({least, cell.capacity(), species.capacity(), partner.capacity()});
}

void Particles::reserve(std::size_t n) {
  for (auto* values : {&x, &y, &z, &u, &v, &w, &rotation}) grow_array(*values, n);
  grow_array(id, n);
  grow_array(cell, n);
  grow_array(species, n);
  grow_array(partner, n);
  if (vibrate_) grow_array(levels, n);
}

void Particles::append(const Particle& p) {
  // A vector left to itself would double, and lose its large pages.
  if (size() == capacity()) reserve(with_room(size()));
  x.push_back(p.position.x);
  y.push_back(p.position.y);
  z.push_back(p.position.z);
  u.push_back(p.velocity.x);
  v.push_back(p.velocity.y);
  w.push_back(p.velocity.z);
  rotation.push_back(p.rotation);
  id.push_back(p.id);
  cell.push_back(p.cell);
  species.push_back(p.species);
  partner.push_back(p.partner);
  if (vibrate_) levels.push_back(p.levels);
}

void Particles::clear() {
  for (auto* values : {&x, &y, &z, &u, &v, &w, &rotation}) values->clear();
  id.clear();
  cell.clear();
  species.clear();
  partner.clear();
  levels.clear();
}

/// Sorts the particles of a cell, `begin` to `end` of `order_`, by id; `spare_` has the bits of their ids, which makes
/// most of it a walk along one short piece of memory. Those that were there before are in order and follow one another;
/// the others are sorted and merged with them.
void Particles::order_by_id(std::size_t begin, std::size_t end) {
  const auto n = end - begin;
  double* const ids = spare_.data() + begin;
  std::uint32_t* const rows = order_.data() + begin;
  const auto id_at = [&](std::size_t k) { return std::bit_cast<std::uint64_t>(ids[k]); };
  const auto put = [&](std::size_t k, Row row) {
    ids[k] = std::bit_cast<double>(row.id);
    rows[k] = row.row;
  };
  if (n <= max_few) {
    std::array<std::uint64_t, max_few> old_id;
    std::array<std::uint32_t, max_few> old_row, rank;
    for (std::size_t k = 0; k < n; ++k) {
      old_id[k] = id_at(k);
      old_row[k] = rows[k];
    }
    rank_few(std::span(old_id).first(n), rank);
    for (std::size_t k = 0; k < n; ++k) put(rank[k], {old_id[k], old_row[k]});
    return;
  }
  std::size_t first = 0, n_ordered = 0;  // of the longest part in order
  for (std::size_t k = 1, from = 0; k <= n; ++k) {
    if (k < n && id_at(k - 1) < id_at(k)) continue;
    if (k - from > n_ordered) {
      first = from;
      n_ordered = k - from;
    }
    from = k;
  }
  if (n_ordered == n) return;
  new_.clear();
  for (std::size_t k = 0; k < n; ++k)
    if (k < first || k >= first + n_ordered) new_.push_back({id_at(k), rows[k]});
  std::sort(new_.begin(), new_.end(), [](const Row& a, const Row& b) { return a.id < b.id; });
  // From behind, once those in order are at the front: what is written has been read.
  for (std::size_t k = 0; k < n_ordered; ++k) put(k, {id_at(first + k), rows[first + k]});
  auto from = n_ordered, to = n;
  for (auto next = new_.end(); next != new_.begin();) {
    const auto row = *--next;
    for (; from > 0 && id_at(from - 1) > row.id; --from) put(--to, {id_at(from - 1), rows[from - 1]});
    put(--to, row);
  }
}

void Particles::sort_by_cell(LocalId n_cells) {
  PAMR_EXPECTS(size() < std::numeric_limits<std::uint32_t>::max());
  const auto n = static_cast<std::size_t>(n_cells);
  assign_array(begin_, n + 2, 0U);
  for (const auto c : cell)
    if (c != gone) ++begin_[static_cast<std::size_t>(c) + 2];
  for (std::size_t c = 2; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
  // begin_[c + 1] is where the next particle of cell c goes, and in the end where cell c + 1 begins.
  const std::size_t n_here = begin_.back();
  remake(order_, n_here);
  remake(spare_, n_here);
  const auto next = std::span(begin_).subspan(1);
  const auto order = std::span(order_);
  const auto ids = std::span(spare_);
  for (std::size_t i = 0; i < cell.size(); ++i) {
    if (i + rows_ahead < cell.size() && cell[i + rows_ahead] != gone) {
      const auto soon = next[static_cast<std::size_t>(cell[i + rows_ahead])];  // or a little behind
      prefetch(&order[soon]);
      prefetch(&ids[soon]);
    }
    if (cell[i] == gone) continue;
    const auto to = next[static_cast<std::size_t>(cell[i])]++;
    order[to] = static_cast<std::uint32_t>(i);
    ids[to] = std::bit_cast<double>(id[i]);
  }
  begin_.pop_back();
  for (std::size_t c = 0; c < n; ++c) order_by_id(begin_[c], begin_[c + 1]);

  id.resize(n_here);
  for (std::size_t i = 0; i < n_here; ++i) id[i] = std::bit_cast<std::uint64_t>(ids[i]);
  for (auto* values : {&x, &y, &z, &u, &v, &w, &rotation}) gather(*values, spare_, order_);
  cell.resize(n_here);
  take(partner, order_, cell);  // as spare memory
  partner.resize(n_here);
  for (std::size_t i = 0; i < n_here; ++i) partner[i] = static_cast<std::uint32_t>(cell[i]);
  if (vibrate_) {
    take(levels, order_, cell);
    levels.resize(n_here);
    for (std::size_t i = 0; i < n_here; ++i) levels[i] = static_cast<std::uint32_t>(cell[i]);
  }
  take(species, order_, order_);  // the order is of no more use: its memory becomes the species
  order_.swap(species);
  for (std::size_t c = 0; c < n; ++c)
    std::fill(cell.begin() + begin_[c], cell.begin() + begin_[c + 1], static_cast<LocalId>(c));
}

std::size_t Particles::bytes() const {
  std::size_t sum = 0;
  for (const auto* values : {&x, &y, &z, &u, &v, &w, &rotation, &spare_}) sum += values->capacity() * sizeof(double);
  sum += id.capacity() * sizeof(std::uint64_t) + cell.capacity() * sizeof(LocalId);
  return sum +
         (species.capacity() + partner.capacity() + levels.capacity() + begin_.capacity() + order_.capacity()) *
             sizeof(std::uint32_t) +
         new_.capacity() * sizeof(Row);
}

}  // namespace pamr::dsmc
