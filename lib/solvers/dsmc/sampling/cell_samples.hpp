// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/kernel/particles.hpp"

namespace pamr::dsmc {

/// Sums over the particles of one species in a cell and over the sampled steps.
struct CellSums {
  double n = 0;
  Vec3 velocity;         ///< m/s
  double square = 0;     ///< of the speed, m2/s2
  double rotation = 0;   ///< J
  double vibration = 0;  ///< K: over Boltzmann's constant
};

/// Samples of the flow in the cells. A cell's sums are taken in the order of its particles' ids, so they do not depend
/// on the number of ranks.
struct CellSamples {
  std::int64_t steps = 0;
  std::vector<CellSums> sums;  ///< n_cells x n_species
  /// For standard errors: the sum of the particles' weights over the steps of the current block, and the sum of the
  /// squares of such sums over the finished blocks.
  std::vector<double> block, square_of_blocks;
  std::int64_t blocks = 0, steps_in_block = 0, steps_in_blocks = 0;

  void clear(std::size_t n_cells, const Gas& gas);
  /// Adds the particles as they are now; they must be sorted by cell. Local, O(particles).
  void add(const Particles& particles, const Gas& gas);
  /// Local.
  void end_block();
};

}  // namespace pamr::dsmc
