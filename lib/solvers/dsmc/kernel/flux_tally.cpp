// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/flux_tally.hpp"

#include <utility>

#include "pamr/base/contract.hpp"

namespace pamr::dsmc {

FluxTally::FluxTally(const Gas& gas, std::size_t n_surfaces, const SurfaceTally& units)
    : fresh_(2 * n_surfaces * gas.species.size()), row_(fresh_.size()) {
  for (const auto& s : gas.species) {
    const double mass = s.weight * s.mass;
    unit_.push_back({mass / units.momentum_unit, 0.5 * mass / units.energy_unit, s.weight / units.energy_unit});
  }
}

void FluxTally::Row::add(const SurfaceTally::Sums& fresh) {
  n += fresh.hits;
  for (std::size_t k = 0; k < 3; ++k) sums[k].add(fresh.momentum[k]);
  sums[3].add(fresh.energy);
}

void FluxTally::fold() {
  for (std::size_t r = 0; r < row_.size(); ++r) row_[r].add(std::exchange(fresh_[r], {}));
  n_fresh_ = 0;
}

std::vector<std::int64_t> FluxTally::words() const {
  std::vector<std::int64_t> words;
  words.reserve(n_words());
  for (std::size_t r = 0; r < row_.size(); ++r) {
    auto row = row_[r];
    row.add(fresh_[r]);
    words.push_back(row.n);
    for (const auto& sum : row.sums) words.insert(words.end(), {sum.low, sum.high});
  }
  return words;
}

void FluxTally::set_words(std::span<const std::int64_t> words) {
  PAMR_EXPECTS(words.size() == n_words());
  clear();
  for (std::size_t r = 0; r < row_.size(); ++r) row_[r] = flux_row(words, r);
}

void FluxTally::clear() {
  fresh_.assign(fresh_.size(), {});
  row_.assign(row_.size(), {});
  n_fresh_ = 0;
}

FluxTally::Row flux_row(std::span<const std::int64_t> words, std::size_t row) {
  const auto w = words.subspan(row * FluxTally::words_of_row, FluxTally::words_of_row);
  FluxTally::Row found{w[0], {}};
  for (std::size_t k = 0; k < found.sums.size(); ++k) found.sums[k] = {w[1 + 2 * k], w[2 + 2 * k]};
  return found;
}

}  // namespace pamr::dsmc
