// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/fluxes.hpp"

#include <algorithm>

namespace pamr::dsmc {

using Way = FluxTally::Way;

std::vector<FluxRate> flux_rates(std::span<const std::int64_t> words, const Gas& gas, const FluxScale& scale) {
  const double per_step = scale.fnum_per_time / static_cast<double>(std::max<std::int64_t>(1, scale.n_steps));
  const double momentum = scale.momentum_unit * per_step, energy = scale.energy_unit * per_step;
  std::vector<FluxRate> rates(words.size() / FluxTally::words_of_row);
  for (std::size_t r = 0; r < rates.size(); ++r) {
    const auto row = flux_row(words, r);
    const double weight = gas.species[(r / 2) % gas.species.size()].weight;
    rates[r] = {per_step * weight * static_cast<double>(row.n), momentum * row.sums[0].value(),
                momentum * row.sums[1].value(), momentum * row.sums[2].value(), energy * row.sums[3].value()};
  }
  return rates;
}

SurfaceFlux mean_flux(const std::vector<std::vector<FluxRate>>& blocks, std::size_t n_groups, std::size_t surface,
                      int species, std::size_t n_species) {
  const auto mean_of = [&](std::size_t quantity, double of_out, double of_in) {
    std::vector<double> values;
    for (const auto& block : blocks) {
      double value = 0;
      for (std::size_t s = 0; s < n_species; ++s)
        if (species < 0 || s == static_cast<std::size_t>(species))
          value += of_out * block[FluxTally::row_of(surface, s, Way::out, n_species)][quantity] +
                   of_in * block[FluxTally::row_of(surface, s, Way::in, n_species)][quantity];
      values.push_back(value);
    }
    return estimate(values, n_groups);
  };
  SurfaceFlux flux;
  for (std::size_t q = 0; q < flux.net.size(); ++q) {
    flux.out[q] = mean_of(q, 1, 0);
    flux.in[q] = mean_of(q, 0, 1);
    flux.net[q] = mean_of(q, 1, -1);
  }
  return flux;
}

std::vector<NetFlux> net_fluxes(const std::vector<FluxRate>& rates, std::size_t n_species) {
  std::vector<NetFlux> net(rates.size() / (2 * n_species));
  for (std::size_t surface = 0; surface < net.size(); ++surface)
    for (std::size_t s = 0; s < n_species; ++s) {
      const auto& out = rates[FluxTally::row_of(surface, s, Way::out, n_species)];
      const auto& in = rates[FluxTally::row_of(surface, s, Way::in, n_species)];
      net[surface][0] += out[0];
      net[surface][1] += in[0];
      for (std::size_t q = 1; q < out.size(); ++q) net[surface][q + 1] += out[q] - in[q];
    }
  return net;
}

std::vector<std::array<double, 2>> molecules_of_species(const std::vector<FluxRate>& rates, std::size_t n_species) {
  std::vector<std::array<double, 2>> molecules;
  if (n_species < 2) return molecules;
  for (std::size_t surface = 0; surface < rates.size() / (2 * n_species); ++surface)
    for (std::size_t s = 0; s < n_species; ++s)
      molecules.push_back({rates[FluxTally::row_of(surface, s, Way::out, n_species)][0],
                           rates[FluxTally::row_of(surface, s, Way::in, n_species)][0]});
  return molecules;
}

}  // namespace pamr::dsmc
