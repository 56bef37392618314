// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <vector>

#include "pamr/par/comm.hpp"
#include "solvers/dsmc/sampling/sample.hpp"

namespace pamr::dsmc {

/// Parts of the cells that have gas in them, and that are fine enough for it.
struct CellQuality {
  double cells_with_gas = 0;
  double size = 0;         ///< cube root of the volume at most the mean free path
  double probability = 0;  ///< of a particle to collide in a step below 1
  double separation = 0;   ///< of collision partners below the mean free path
  double particles = 0;    ///< at least 10 on average
  double all = 0;          ///< these four together
  double cells_of_dense_gas = 0;
  double few_in_dense_gas = 0;  ///< of the cells denser than the free stream: fewer than 5 particles on average
};

/// From the fields of `flow_fields`. Collective.
CellQuality judge_cells(const par::Comm& comm, const std::vector<CellQuantity>& fields, double free_density);
nlohmann::json to_json(const CellQuality& quality);

}  // namespace pamr::dsmc
