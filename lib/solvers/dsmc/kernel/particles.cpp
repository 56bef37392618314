// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/particles.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "pamr/base/contract.hpp"

namespace pamr::dsmc {

namespace {

constexpr std::size_t few_rows = 24;  ///< particles of a cell, which are sorted by insertion

constexpr std::size_t with_room(std::size_t n) { return n + std::max<std::size_t>(1024, n / 16); }

/// Resizes an array whose contents do not matter; a vector left to itself would double.
template <class T>
void remake(std::vector<T>& rows, std::size_t n) {
  if (rows.capacity() < n) {
    rows = {};
    rows.reserve(with_room(n));
  }
  rows.resize(n);
}

/// Rows `order` of `rows`, in that order, through `spare`.
void gather(std::vector<double>& rows, std::vector<double>& spare, std::span<const std::uint32_t> order) {
  remake(spare, order.size());
  for (std::size_t i = 0; i < order.size(); ++i) spare[i] = rows[order[i]];
  rows.swap(spare);
}

/// The same for integers, so that the same spare memory serves.
void gather(std::vector<std::uint64_t>& rows, std::vector<double>& spare, std::span<const std::uint32_t> order) {
  remake(spare, order.size());
  for (std::size_t i = 0; i < order.size(); ++i) spare[i] = std::bit_cast<double>(rows[order[i]]);
  rows.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) rows[i] = std::bit_cast<std::uint64_t>(spare[i]);
}

}  // namespace

void Particles::reserve_one_more() {
  if (x.size() < x.capacity()) return;
  const auto room = with_room(x.size());  // a doubling would waste memory
  for (auto* values : {&x, &y, &z, &u, &v, &w, &rotation}) values->reserve(room);
  id.reserve(room);
  cell.reserve(room);
  species.reserve(room);
  partner.reserve(room);
}

void Particles::append(const Particle& p) {
  reserve_one_more();
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
}

void Particles::clear() {
  for (auto* values : {&x, &y, &z, &u, &v, &w, &rotation}) values->clear();
  id.clear();
  cell.clear();
  species.clear();
  partner.clear();
}

/// Sorts the particles `rows` of a cell by id. Those that were there before are in order and follow one another; the
/// others are sorted and merged with them.
void Particles::order_by_id(std::span<std::uint32_t> rows) {
  if (rows.size() <= few_rows) {
    for (std::size_t k = 1; k < rows.size(); ++k) {
      const auto row = rows[k];
      const auto key = id[row];
      auto to = k;
      for (; to > 0 && id[rows[to - 1]] > key; --to) rows[to] = rows[to - 1];
      rows[to] = row;
    }
    return;
  }
  std::size_t first = 0, n_ordered = 0;  // of the longest part in order
  for (std::size_t k = 1, from = 0; k <= rows.size(); ++k) {
    if (k < rows.size() && id[rows[k - 1]] < id[rows[k]]) continue;
    if (k - from > n_ordered) {
      first = from;
      n_ordered = k - from;
    }
    from = k;
  }
  if (n_ordered == rows.size()) return;
  const auto ordered = rows.subspan(first, n_ordered), rest = rows.subspan(first + n_ordered);
  new_.assign(rows.begin(), ordered.begin());
  new_.insert(new_.end(), rest.begin(), rest.end());
  std::sort(new_.begin(), new_.end(), [&](std::uint32_t a, std::uint32_t b) { return id[a] < id[b]; });
  // From behind, once those in order are at the front: what is written has been read.
  std::copy(ordered.begin(), ordered.end(), rows.begin());
  auto from = rows.begin() + static_cast<std::ptrdiff_t>(n_ordered), to = rows.end();
  for (auto next = new_.end(); next != new_.begin();) {
    const auto row = *--next;
    const auto key = id[row];
    while (from != rows.begin() && id[*(from - 1)] > key) *--to = *--from;
    *--to = row;
  }
}

void Particles::sort_by_cell(LocalId n_cells) {
  PAMR_EXPECTS(size() < std::numeric_limits<std::uint32_t>::max());
  const auto n = static_cast<std::size_t>(n_cells);
  begin_.assign(n + 2, 0);
  for (const auto c : cell)
    if (c != gone) ++begin_[static_cast<std::size_t>(c) + 2];
  for (std::size_t c = 2; c < begin_.size(); ++c) begin_[c] += begin_[c - 1];
  // begin_[c + 1] is where the next particle of cell c goes, and in the end where cell c + 1 begins.
  remake(order_, begin_.back());
  for (std::size_t i = 0; i < cell.size(); ++i)
    if (cell[i] != gone) order_[begin_[static_cast<std::size_t>(cell[i]) + 1]++] = static_cast<std::uint32_t>(i);
  begin_.pop_back();
  for (std::size_t c = 0; c < n; ++c) order_by_id(std::span(order_).subspan(begin_[c], begin_[c + 1] - begin_[c]));

  for (auto* values : {&x, &y, &z, &u, &v, &w, &rotation}) gather(*values, spare_, order_);
  gather(id, spare_, order_);
  cell.resize(order_.size());
  for (std::size_t i = 0; i < order_.size(); ++i)
    cell[i] = static_cast<LocalId>(partner[order_[i]]);  // as spare memory
  partner.resize(order_.size());
  for (std::size_t i = 0; i < order_.size(); ++i) partner[i] = static_cast<std::uint32_t>(cell[i]);
  for (auto& row : order_) row = species[row];  // the order is of no more use: its memory becomes the species
  order_.swap(species);
  for (std::size_t c = 0; c < n; ++c)
    std::fill(cell.begin() + begin_[c], cell.begin() + begin_[c + 1], static_cast<LocalId>(c));
}

std::size_t Particles::bytes() const {
  std::size_t sum = 0;
  for (const auto* values : {&x, &y, &z, &u, &v, &w, &rotation, &spare_}) sum += values->capacity() * sizeof(double);
  sum += id.capacity() * sizeof(std::uint64_t) + cell.capacity() * sizeof(LocalId);
  return sum + (species.capacity() + partner.capacity() + begin_.capacity() + order_.capacity() + new_.capacity()) *
                   sizeof(std::uint32_t);
}

}  // namespace pamr::dsmc
