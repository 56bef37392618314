// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/kernel/flux_tally.hpp"
#include "solvers/dsmc/sampling/estimate.hpp"

namespace pamr::dsmc {

/// Rates through a surface: molecules (1/s), momentum (N, three components), energy (W).
using FluxRate = std::array<double, 5>;

/// Factors that turn the sums of `FluxTally` into rates.
struct FluxScale {
  double momentum_unit = 1, energy_unit = 1;  ///< of `SurfaceTally`
  double fnum_per_time = 1;                   ///< real molecules per particle and second
  std::int64_t n_steps = 1;
};

/// The rate of each row of the tally. `words`: of all ranks. Local.
std::vector<FluxRate> flux_rates(std::span<const std::int64_t> words, const Gas& gas, const FluxScale& scale);

/// Flux through a surface, of one species or of all.
struct SurfaceFlux {
  using Estimates = std::array<Estimate, 5>;  ///< as in `FluxRate`
  Estimates out, in;                          ///< of a plane: along its normal, against it
  Estimates net;                              ///< out less in: what the gas leaves there
};
/// Means over the blocks, with standard errors from `n_groups` groups of them. `blocks`: rates of all rows in each;
/// `species` below 0: all of `n_species` together. Local.
SurfaceFlux mean_flux(const std::vector<std::vector<FluxRate>>& blocks, std::size_t n_groups, std::size_t surface,
                      int species, std::size_t n_species);

/// Columns of the history for a surface: molecules per second out and in, net momentum (N) and energy (W).
using NetFlux = std::array<double, 6>;
/// For each surface, all species together. Local.
std::vector<NetFlux> net_fluxes(const std::vector<FluxRate>& rates, std::size_t n_species);
/// Molecules a second out and in, of each surface its species; empty for a gas of one species. Local.
std::vector<std::array<double, 2>> molecules_of_species(const std::vector<FluxRate>& rates, std::size_t n_species);

}  // namespace pamr::dsmc
