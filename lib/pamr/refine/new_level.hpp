// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/movable.hpp"
#include "pamr/refine/number.hpp"
#include "pamr/refine/subdivide.hpp"

namespace pamr::refine {

/// What the steps that move nodes read of the refined mesh, whose cells are not linked yet. Only references; the
/// positions, which change, are passed beside it.
struct NewLevel {
  const mesh::DistMesh& mesh;            ///< that is refined
  const mesh::MeshInfo& info;            ///< patches, with the planes of flat ones
  const geometry::SurfaceSet& surfaces;  ///< those that nodes are put onto
  const Numbering& numbering;
  const Children& children;
  const par::Pattern& shared;  ///< nodes that other ranks hold too

  LocalId n_cells() const { return static_cast<LocalId>(children.cell_to_node.size()); }
  std::size_t n_nodes() const { return at(numbering.n_old_nodes) + numbering.n_new_nodes(); }
  geometry::TetPoints points(LocalId cell, const std::vector<geometry::Vec3>& position) const {
    const auto& n = children.cell_to_node[at(cell)];
    return {position[at(n[0])], position[at(n[1])], position[at(n[2])], position[at(n[3])]};
  }
};

/// This rank's cells with a node of `movables`, ascending. Local.
std::vector<LocalId> cells_with_moved_nodes(const NewLevel& level, const std::vector<Movable>& movables);

}  // namespace pamr::refine
