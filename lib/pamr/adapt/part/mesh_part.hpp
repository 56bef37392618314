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

/// What is asked of the cells of a mesh, and what its closure says of them. Only references.
struct WholeCells {
  std::span<const std::uint8_t> requests;
  const refine::Closure& closure;
};

/// The same with the mesh. Only references.
struct WholeMesh {
  const mesh::DistMesh& mesh;
  const mesh::Borders& borders;
  WholeCells cells;
};

/// Cells that follow each other.
struct CellRange {
  LocalId first = 0, count = 0;
};

/// Which cells of a whole mesh a part has, and which it gets when it is widened next.
struct Coverage {
  enum State : std::uint8_t { outside, held, added };
  std::vector<State> of_cell;
  std::vector<CellRange> ranges;  ///< those that are added, ascending
};

/// Some cells of a whole mesh, or what has become of them. A face behind which the whole mesh has a cell, but the part
/// has not, is *open*: its slot is that of a patch beyond the last. Cells with open faces are those of the whole mesh.
struct MeshPart {
  mesh::DistMesh mesh;
  bool is_cut = false;                 ///< false: it was never widened
  std::vector<LocalId> whole_cell;     ///< of each cell: the cell that it came from, or its family's first; ascending
  std::vector<LocalId> whole_node;     ///< of the first nodes, ascending; the nodes after them are new
  std::vector<std::uint8_t> requests;  ///< of each cell
  refine::Carried known;               ///< marks and plans of the closure
  std::vector<std::uint8_t> has_face;  ///< of each rank-border face of the whole mesh: the cells on both sides are held
};

/// What stands in the place of a neighbor behind an open face.
LocalId open_slot(const mesh::MeshInfo& info);
/// Cells with an open face, ascending. Local.
std::vector<LocalId> open_cells(const MeshPart& part);

/// Adds the cells within `n_layers` faces of the seeds (cells of the whole mesh), families as a whole, across one rank
/// border at most. Collective: one exchange.
void spread(const par::Comm& comm, const WholeMesh& whole, const std::vector<LocalId>& seeds, int n_layers,
            Coverage& coverage);
/// Adds all cells that are not held. Local.
void cover_all(Coverage& coverage);
/// Only the cells that are held. Local.
Coverage held_of(const Coverage& coverage);

/// The part with the cells that were added: in the order of the whole mesh, and with numbers without gaps in that
/// order. The part may be empty at first.
/// Collective: a scan, a gather and two exchanges, and four sparse ones where ranks hold no runs of cell numbers.
MeshPart widen(const par::Comm& comm, const WholeMesh& whole, const MeshPart& part, Coverage& coverage);

}  // namespace pamr::adapt
