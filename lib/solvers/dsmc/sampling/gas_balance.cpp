// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/gas_balance.hpp"

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <numeric>

#include "solvers/dsmc/kernel/flux_tally.hpp"

namespace pamr::dsmc {

namespace {

std::array<WideSum, 4> conserved(const GasContents& contents) {
  auto energy = contents.translation;
  energy += contents.rotation;
  energy += contents.deficit;
  if (contents.vibration) energy += *contents.vibration;
  return {contents.momentum[0], contents.momentum[1], contents.momentum[2], energy};
}

std::int64_t sum_of(const std::vector<std::int64_t>& n) { return std::accumulate(n.begin(), n.end(), std::int64_t{0}); }

}  // namespace

void GasBalance::add(const GasContents& before_it, const GasContents& after_it, std::span<const std::int64_t> fluxes,
                     std::size_t n_patches, std::int64_t n_collisions) {
  constexpr std::int64_t collisions_of_a_rounding = 1024;  // velocities have 2^-52 where sums have 2^-30
  using Way = FluxTally::Way;
  const auto n_species = before_it.n.size();
  auto rest = conserved(after_it);
  const auto begin = conserved(before_it);
  for (std::size_t k = 0; k < rest.size(); ++k) rest[k] -= begin[k];
  std::int64_t n_passed = 0;
  for (std::size_t s = 0; s < n_species; ++s) {
    auto n_rest = after_it.n[s] - before_it.n[s];
    for (std::size_t p = 0; p < n_patches; ++p) {
      const auto gone = flux_row(fluxes, FluxTally::row_of(p, s, Way::out, n_species));
      const auto come = flux_row(fluxes, FluxTally::row_of(p, s, Way::in, n_species));
      n_rest += gone.n - come.n;
      n_passed += gone.n + come.n;
      out += gone.n;
      in += come.n;
      for (std::size_t k = 0; k < rest.size(); ++k) {
        rest[k] += gone.sums[k];
        rest[k] -= come.sums[k];
      }
    }
    unexplained += std::abs(n_rest);
  }
  if (n_intervals++ == 0) before = sum_of(before_it.n);
  after = sum_of(after_it.n);
  const std::int64_t n_rounded_by_collisions = n_collisions / collisions_of_a_rounding;
  const double n = static_cast<double>(sum_of(before_it.n) + after + n_passed + n_rounded_by_collisions);
  const auto share = [&](const WideSum& sum) { return allowed * std::fabs(sum.value()) / std::max(1.0, n); };
  for (std::size_t k = 0; k < 3; ++k) momentum = std::max(momentum, share(rest[k]));
  energy = std::max(energy, share(rest[3]));
}

}  // namespace pamr::dsmc
