// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::balance {

/// Cuts the cells, in their global order, into one run for each part so that the runs weigh the same as nearly as whole
/// cells allow (`par::runs_of_equal_work`), wherever they are, whole families in one part (of their first member): the
/// part of each of this rank's cells. As good as the order of the cells is local (files of `pamr-mesh` follow a Hilbert
/// curve, and children follow their parents). `weight`: positive, one for each cell of this rank. Collective: the
/// weights go to the canonical blocks of the cells and the parts come back, 16 bytes a cell, where the ranks do not
/// hold runs of cells already.
std::vector<Rank> weighted_blocks(const par::Comm& comm, const mesh::DistMesh& mesh,
                                  std::span<const std::int64_t> weight, Rank n_parts);

}  // namespace pamr::balance
