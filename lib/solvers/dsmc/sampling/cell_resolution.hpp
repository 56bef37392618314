// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "pamr/par/comm.hpp"
#include "solvers/dsmc/sampling/cell_flow.hpp"

namespace pamr::dsmc {

/// How many of the cells with gas in them are fine enough for it, as fractions.
struct CellResolution {
  double cells_with_gas = 0;
  double size = 0;                ///< cube root of the volume at most the mean free path
  double probability = 0;         ///< chance of a particle to collide in a step below 1
  double separation = 0;          ///< distance of collision partners below the mean free path
  double particles = 0;           ///< at least 10 on average
  double all = 0;                 ///< these four together
  double cells_of_dense_gas = 0;  ///< cells denser than the free stream
  double few_in_dense_gas = 0;    ///< of these: fewer than 5 particles on average
  double wall_separation = 0;     ///< of collision partners at the walls of the body over the mean free path, by heat
  double wall_cell_size = 0;      ///< cube root of the volume of cells at the walls over it, weighted likewise
  double max_temperature = 0;     ///< K, of cells with 100 samples or more; 0 if there are none
};

/// `free_density`: of the free stream, 1/m3; `n_steps` that were averaged. Collective.
CellResolution assess_resolution(const par::Comm& comm, const CellFlow& flow, double free_density,
                                 std::int64_t n_steps);
nlohmann::json to_json(const CellResolution& resolution);
/// Warnings about cells that are too coarse, few particles and hot molecules. `gas`: null if molecules do not collide. Local.
std::vector<std::string> warnings_of(const CellResolution& resolution, const Gas* gas);

}  // namespace pamr::dsmc
