// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/par/comm.hpp"

namespace pamr::dsmc {

/// Global numbers of items that belong to cells (particles, faces), in the global order of the cells and so independent
/// of the partition.
struct Numbering {
  std::vector<std::int64_t> first;  ///< number of the first item of each given cell
  std::int64_t total = 0;           ///< items of all cells on all ranks
};

/// `cell`: global numbers of cells of this rank, ascending; `count`: items of each. Cells that no rank names have none.
/// `n_cells`: of the whole mesh. Collective: four sparse exchanges and a scan. Memory O(cells / ranks).
Numbering number_along_cells(const par::Comm& comm, GlobalId n_cells, std::span<const GlobalId> cell,
                             std::span<const std::int64_t> count);

}  // namespace pamr::dsmc
