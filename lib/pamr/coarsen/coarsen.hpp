// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/coarsen/coarse_fields.hpp"
#include "pamr/coarsen/octets.hpp"
#include "pamr/coarsen/settle_octets.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::coarsen {

/// A mesh of which octets were taken back.
struct Coarsened {
  mesh::DistMesh mesh;              ///< with `cell_origin`
  std::vector<std::uint8_t> flags;  ///< of its cells: 1 where the old cell had a flag above 0
  std::vector<Merged> merged;       ///< cells that are gone
};

/// The mesh without the octets of `settled`, its families closed as that says. Cells and nodes that stay keep their
/// order and are numbered without gaps; a parent lies where its first child was. Cells stay on their ranks. The result
/// is valid, and the same whatever the partition. `flags`: of the old cells. Collective: a few sparse exchanges over
/// nodes and rank borders (on one rank none). Memory: the new mesh and about 20 bytes a cell.
Coarsened take_back(const par::Comm& comm, const mesh::DistMesh& mesh, const Settled& settled,
                    std::span<const std::int8_t> flags, const FieldRules& rules);

}  // namespace pamr::coarsen
