// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/carried.hpp"
#include "pamr/refine/closure.hpp"

/// Parts of a mesh that are worked on alone, as meshes of their own, and put back afterwards: so work costs what the
/// part costs, and the rest is touched once.
namespace pamr::adapt {

/// A mesh with what is asked of its cells and what its closure says of them. Only references.
struct WholeMesh {
  const mesh::DistMesh& mesh;
  const mesh::Borders& borders;
  std::span<const std::uint8_t> requests;
  const refine::Closure& closure;
};

/// Some cells of a whole mesh, or what has become of them. A face behind which the whole mesh has a cell, but the part
/// has not, is *open*: its slot is that of a patch beyond the last. Cells with open faces are those of the whole mesh.
struct MeshPart {
  mesh::DistMesh mesh;
  std::vector<LocalId> whole_cell;     ///< of each cell: the cell that it came from, or its family's first; ascending
  std::vector<LocalId> whole_node;     ///< of the first nodes, ascending; the nodes after them are new
  std::vector<std::uint8_t> requests;  ///< of each cell
  refine::Carried known;               ///< marks and plans of the closure
  std::vector<std::uint8_t> holds;     ///< for each cell of the whole mesh whether the part holds it
  std::vector<std::uint8_t> has_face;  ///< the same of each rank-border face: the cells on both sides

  LocalId open_slot() const { return mesh::patch_to_slot(static_cast<int>(mesh.info.patches.size())); }
};

/// Cells with an open face, ascending; local.
std::vector<LocalId> open_cells(const MeshPart& part);
/// The nodes of open faces, with repeats; local.
std::vector<LocalId> open_nodes(const MeshPart& part);

/// Adds to `holds` the cells within `n_layers` faces of the seeds (cells of the whole mesh), families as a whole,
/// across one rank border at most. Collective: one exchange.
void spread(const par::Comm& comm, const WholeMesh& whole, const std::vector<LocalId>& seeds, int n_layers,
            std::vector<std::uint8_t>& holds);

/// The part, none at first, with the cells that `holds` names beyond those that it has already: in the order of the
/// whole mesh, and with numbers without gaps in that order. With all cells it is the whole mesh, as it has become.
/// Collective: a scan and two exchanges, and four sparse exchanges where ranks hold no runs of cell numbers.
MeshPart widen(const par::Comm& comm, const WholeMesh& whole, const MeshPart& part, std::vector<std::uint8_t> holds);

}  // namespace pamr::adapt
