// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/coarsen/coarse_links.hpp"
#include "pamr/coarsen/octets.hpp"
#include "pamr/coarsen/settle_octets.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::coarsen {

/// A mesh of which octets were coarsened.
struct Coarsened {
  mesh::DistMesh mesh;              ///< without fields, but for those of `carry_level0`
  NewPlaces places;                 ///< of the old cells
  std::vector<LocalId> old_node;    ///< old local number of each node
  std::vector<std::uint8_t> flags;  ///< of its cells: 1 where the old cell had a flag above 0
};

/// The mesh without the octets of `settled`, its families closed as that says. Cells and nodes that stay keep their
/// order and are numbered without gaps; a parent lies where its first child was. Cells stay on their ranks. The result
/// is valid, and the same whatever the partition. `flags`: of the old cells. Collective: a few sparse exchanges over
/// nodes and rank borders (on one rank none). Memory: the new mesh and about 20 bytes a cell.
Coarsened take_back(const par::Comm& comm, const mesh::DistMesh& mesh, const Settled& settled,
                    std::span<const std::int8_t> flags);

/// The old nodes that are gone and that lie on edges of the coarse mesh that have marks: they are needed after all.
/// `marks`: of the cells of the coarse mesh. Local.
std::vector<LocalId> find_needed_nodes(const Settled& settled, const Coarsened& coarse,
                                       std::span<const refine::EdgeMask> marks);

}  // namespace pamr::coarsen
