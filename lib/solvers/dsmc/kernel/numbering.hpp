// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/par/comm.hpp"

namespace pamr::dsmc {

/// Numbers of things that belong to cells, along the global order of the cells and so the same for any partition.
struct Numbering {
  std::vector<std::int64_t> first;  ///< number of the first thing of each given cell
  std::int64_t total = 0;           ///< things of all cells on all ranks
};

/// `cell`: global numbers, ascending, of cells of this rank; `count`: things of each; cells not named by any rank have
/// none. `n_cells` of the whole mesh. Collective: four sparse exchanges and a scan; memory O(cells / ranks).
Numbering number_along_cells(const par::Comm& comm, GlobalId n_cells, std::span<const GlobalId> cell,
                             std::span<const std::int64_t> count);

}  // namespace pamr::dsmc
