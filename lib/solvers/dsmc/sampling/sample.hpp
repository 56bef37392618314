// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/kernel/collide.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"
#include "solvers/dsmc/kernel/particles.hpp"

namespace pamr::dsmc {

/// Sums over the particles of one species in a cell and over the sampled steps.
struct CellSums {
  double n = 0;
  Vec3 velocity;        ///< m/s
  double square = 0;    ///< of the speed, m2/s2
  double rotation = 0;  ///< J
};

/// What has been sampled of the flow in the cells. Sums of a cell run in the order of its particles' ids, so they do
/// not depend on the number of ranks.
struct CellSamples {
  std::int64_t steps = 0;
  std::vector<CellSums> sums;  ///< n_cells x n_species
  /// For standard errors: particles in the cell, each times its species' weight, summed over the steps of the block
  /// under way, and the sum of the squares of these sums over the finished blocks.
  std::vector<double> block, square_of_blocks;
  std::int64_t blocks = 0, steps_in_block = 0, steps_in_blocks = 0;

  void clear(std::size_t n_cells, const Gas& gas);
  /// Adds the particles as they are now; they must be sorted by cell. Local, O(particles).
  void add(const Particles& particles, const Gas& gas);
  void end_block();
};

/// One averaged quantity in every cell.
struct CellQuantity {
  std::string name, unit;
  int n_components = 1;
  std::vector<double> value;
};

/// The flow in the cells: number density `n`, `rho`, velocity `u`, `T_tr`, `T_rot`, `T`, `Ma`, mean free path `lambda`,
/// mean collision time `tau_c`, `Kn_cell` (lambda / cube root of the volume), `particles` a cell, `n_stderr` (standard
/// error of n from blocks; 0 with fewer than two), `collision_probability` of a particle in a step, and
/// `separation_over_lambda` of collision partners; with several species also `n_<name>`. In an empty cell mean free
/// path and collision time are 1e30, temperatures and velocity 0. Local.
std::vector<CellQuantity> flow_fields(const Domain& domain, const Gas& gas, const CellSamples& samples,
                                      const std::vector<CellCollisions>& collisions, double unit);

}  // namespace pamr::dsmc
