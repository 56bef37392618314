// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "pamr/adapt/part/mesh_part.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/carried.hpp"

namespace pamr::adapt {

/// The whole mesh or a copy of it, and its cells.
struct PartTarget {
  mesh::DistMesh mesh;
  WholeCells cells;
};

/// The whole mesh with the part put back, and what is known of it.
struct PutBack {
  mesh::DistMesh mesh;
  std::vector<std::uint8_t> requests;
  refine::Carried known;
  std::vector<LocalId> whole_cell;  ///< of each cell, as of a part; empty if nobody wants it
};

/// The whole mesh with the part put back: in its order, cells numbered without gaps. It gets `cell_origin`. Cost: arrays of
/// cells are moved by the few places that the part needs more or less; memory only where an array has no room for that.
/// Collective, as `widen`.
PutBack put_back(const par::Comm& comm, PartTarget into, const MeshPart& part, Coverage& coverage,
                 bool with_whole_cells);

/// A copy without fields, with room for so many cells and nodes. Local.
mesh::DistMesh copy_without_fields(const mesh::DistMesh& mesh, std::size_t n_cells, std::size_t n_nodes);
/// A copy with room for so many cells and nodes. Local.
mesh::DistMesh copy_with_room(const mesh::DistMesh& mesh, std::size_t n_cells, std::size_t n_nodes);

}  // namespace pamr::adapt
