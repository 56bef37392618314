// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/particles.hpp"

#include <algorithm>
#include <bit>
#include <limits>

#include "pamr/base/contract.hpp"

namespace pamr::dsmc {

namespace {

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
void gather(std::vector<std::uint32_t>& rows, std::vector<double>& spare, std::span<const std::uint32_t> order) {
  remake(spare, order.size());
  for (std::size_t i = 0; i < order.size(); ++i) spare[i] = rows[order[i]];
  rows.resize(order.size());
  for (std::size_t i = 0; i < order.size(); ++i) rows[i] = static_cast<std::uint32_t>(spare[i]);
}
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

  for (std::size_t c = 0; c < n; ++c)  // by id: cells hold few particles, most of them in order already
    for (auto k = begin_[c] + 1; k < begin_[c + 1]; ++k) {
      const auto item = order_[k];
      const auto key = id[item];
      auto to = k;
      for (; to > begin_[c] && id[order_[to - 1]] > key; --to) order_[to] = order_[to - 1];
      order_[to] = item;
    }

  for (auto* values : {&x, &y, &z, &u, &v, &w, &rotation}) gather(*values, spare_, order_);
  gather(id, spare_, order_);
  gather(partner, spare_, order_);
  for (auto& row : order_) row = species[row];  // the order is of no more use: its memory becomes the species
  order_.swap(species);
  cell.resize(species.size());
  for (std::size_t c = 0; c < n; ++c)
    std::fill(cell.begin() + begin_[c], cell.begin() + begin_[c + 1], static_cast<LocalId>(c));
}

std::size_t Particles::bytes() const {
  std::size_t sum = 0;
  for (const auto* values : {&x, &y, &z, &u, &v, &w, &rotation, &spare_}) sum += values->capacity() * sizeof(double);
  sum += id.capacity() * sizeof(std::uint64_t) + cell.capacity() * sizeof(LocalId);
  return sum +
         (species.capacity() + partner.capacity() + begin_.capacity() + order_.capacity()) * sizeof(std::uint32_t);
}

}  // namespace pamr::dsmc
