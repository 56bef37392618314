// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::balance {

/// Cuts Hilbert's curve through the box of all nodes into one piece for each part so that the cells on the pieces weigh
/// the same, whatever the numbers of the cells and wherever they are: the part (0 .. n_parts-1) of each of this rank's
/// cells. A cell lies where its centroid is, a closure family where its first member's is. Pieces end where the weight
/// of all before them is nearest to their share, to a thousandth of a part or as nearly as whole families allow.
/// `weight`: positive, one for each cell of this rank, of sum at most `max_total_weight`. Does not depend on how the
/// cells are spread over the ranks. Collective: a few reductions (at most 21) of 4096 or `8 n_parts` integers; no cell
/// is sent. Cost: O(cells) time, 16 bytes a cell.
std::vector<Rank> parts_along_curve(const par::Comm& comm, const mesh::DistMesh& mesh,
                                    std::span<const std::int64_t> weight, Rank n_parts);

}  // namespace pamr::balance
