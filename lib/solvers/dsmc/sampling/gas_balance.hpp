// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "solvers/dsmc/kernel/wide_sum.hpp"

namespace pamr::dsmc {

/// All particles of all ranks together, exactly; momentum and energies times the species' weights, units of
/// `SurfaceTally`.
struct GasContents {
  std::vector<std::int64_t> n;  ///< of each species; empty: not known
  std::array<WideSum, 3> momentum{};
  WideSum translation, rotation;
  WideSum deficit;                        ///< energy that cells owe to collisions of unlike weights
  std::optional<WideSum> vibration = {};  ///< none: nothing vibrates
};

/// Whether what is in the gas changed by what passed the patches. In particles, which keep their weight when they go
/// from cell to cell, this holds with local time steps and weights of species, too.
struct GasBalance {
  /// Rounding of a number in fixed point, over a typical value of it.
  static constexpr double allowed = 0x1p-30;

  std::int64_t n_intervals = 0;
  std::int64_t before = 0, in = 0, out = 0, after = 0;  ///< particles
  std::int64_t unexplained = 0;  ///< particles of all species and intervals that came or went otherwise
  /// Largest imbalance of any interval, relative: divided by the typical momentum or energy of a particle and by the
  /// number of particles before, after and crossing, and one for each 1,024 collisions, which round.
  double momentum = 0, energy = 0;

  bool holds() const { return unexplained == 0 && momentum <= allowed && energy <= allowed; }
  /// Adds an interval: contents before and after it, the words of `FluxTally` of all ranks (those of the first
  /// `n_patches` surfaces count) and collisions in it. Local.
  void add(const GasContents& before_it, const GasContents& after_it, std::span<const std::int64_t> fluxes,
           std::size_t n_patches, std::int64_t n_collisions);
};

}  // namespace pamr::dsmc
