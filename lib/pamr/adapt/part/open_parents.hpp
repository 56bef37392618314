// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "pamr/adapt/pass.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/number.hpp"
#include "pamr/refine/options.hpp"

/// Which input cell holds a new cell's centroid, in a refinement of several passes. Where a family of the input is
/// taken back by a pass that is not the last, its members are gone before the new cell is made: it is left open which
/// of them it is, and asked of the rank that has the input.
namespace pamr::adapt {

/// `DistMesh::cell_origin` of the mesh that an early pass makes: the number of the input cell, or below zero where it
/// is open; then it names this rank and the first member of the input's family. `input_cell`: this rank's input cell of
/// each cell of the pass's old mesh; empty: that is the input. Local.
std::vector<GlobalId> origins_of_pass(Rank rank, const refine::NumberedMesh& pass,
                                      const std::vector<mesh::CellNodes>& cell_to_node,
                                      std::span<const LocalId> input_cell);

/// A cell of the refined mesh whose parent is open.
struct OpenParent {
  LocalId cell = 0;
  GlobalId origin = 0;      ///< below zero
  geometry::Vec3 centroid;  ///< while the new nodes of the last pass still lie on their edges
};

/// Those of the last pass. Local.
std::vector<OpenParent> find_open_parents(const refine::NumberedMesh& last,
                                          const std::vector<mesh::CellNodes>& cell_to_node);

/// Writes what depends on the parents into the cell fields of the refined mesh: `parent`, if the options ask for it,
/// and fields of integers. Collective: two sparse exchanges, if any rank has such cells.
void settle_open_parents(const par::Comm& comm, const InputCells& input, const std::vector<OpenParent>& open,
                         const refine::Options& options, mesh::DistMesh& fine);

}  // namespace pamr::adapt
