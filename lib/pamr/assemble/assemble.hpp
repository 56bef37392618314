// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pamr/mesh/block_mesh.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::assemble {

/// Builds the distributed mesh: sends every cell to `destination[i]` (empty on every rank: stay) together with its
/// fields, moves whole families to the destination of their first member, fetches the nodes, builds neighbors where
/// the blocks have none, and lists rank-border faces. Where neighbors are built, boundary faces get the patches of the
/// boundary triangles on them, those without triangle the patch `boundary`; without any triangles all get patch 0, and
/// a patch `boundary` is made where there is none. Local nodes are numbered in order of first use by the cells.
/// Collective: a sparse exchange for each 2^17 cells that leave a rank, a few proportional to the nodes, to the rank
/// border and to the cells sent (their directory); without destinations nothing is sent of the cells but families cut
/// by a block border. Throws `Error` on every rank for node, cell or patch numbers out of range, a node twice in a
/// cell, a face in three cells, a neighbor that is not reciprocal, boundary triangles that are inside or contradict one
/// another or the neighbors, families that are not whole, contiguous and in template order, blocks or fields whose
/// sizes do not fit. Does not look at coordinates and patches inside (`mesh::require_inner_patches`). Cost: O(cells +
/// nodes) time; where neighbors are built O(cells log(faces at a node)).
mesh::DistMesh assemble(const par::Comm& comm, mesh::BlockMesh block, std::span<const Rank> destination = {});

}  // namespace pamr::assemble
