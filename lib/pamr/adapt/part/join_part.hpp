// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/adapt/part/mesh_part.hpp"
#include "pamr/adapt/part/part_runs.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/closure.hpp"

/// Pieces of widening a part and of putting it back.
namespace pamr::adapt {

/// `MeshPart::whole_cell` of the cells in their new order. Local.
std::vector<LocalId> cells_of_whole(const PartRuns& runs, const MeshPart& before);

/// The plans of both, ascending. Local.
std::vector<refine::RebuiltFamily> join_plans(const PartRuns& runs, const WholeCells& whole, const MeshPart& before);

/// The new neighbors of a cell of the whole mesh that had `links`; faces on rank borders are left open. `run`: that the
/// cell is of. Local.
mesh::CellNeighbors links_of_whole(const PartRuns& runs, const mesh::DistMesh& whole, const Run& run,
                                   mesh::CellNeighbors links);
/// The same of a cell of the part before. Local.
mesh::CellNeighbors links_of_part(const PartRuns& runs, const mesh::DistMesh& whole, const MeshPart& before,
                                  LocalId cell);

/// Faces on rank borders, as `mesh::DistMesh` has them.
struct BorderFaces {
  std::vector<Rank> border_rank;
  std::vector<std::size_t> border_offset{0};
  std::vector<mesh::CellFace> border_face;
};
/// Those of the part before come first, then those that are new to it: the same on both sides. `has_face`: as
/// `MeshPart` has it. Local.
BorderFaces join_border_faces(const PartRuns& runs, const mesh::DistMesh& whole, const MeshPart& before,
                              const std::vector<std::uint8_t>& has_face);

/// Gives cells numbers without gaps, in the order of the whole mesh. `of_cell` may be the array of the whole mesh.
/// Returns how many cells there are on all ranks. Collective.
GlobalId number_in_order(const par::Comm& comm, const PartRuns& runs, const mesh::DistMesh& whole,
                         const MeshPart& before, std::vector<GlobalId>& of_cell);

/// `ghost_global` of a mesh whose cells are numbered. Collective: one exchange.
std::vector<GlobalId> numbers_behind_border(const par::Comm& comm, const mesh::DistMesh& mesh);

}  // namespace pamr::adapt
