// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/base/exact.hpp"
#include "pamr/locate/cell_tree.hpp"
#include "pamr/locate/walk.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::locate {

/// Finds the cells of this rank that hold points. The mesh must outlive it and stay as it is.
class Locator {
 public:
  /// Local. Cost: O(cells), 11 bytes a cell.
  explicit Locator(const mesh::DistMesh& mesh) : mesh_(&mesh), tree_(mesh) {}

  /// The cell of this rank that holds the point, inside or on its surface, by exact predicates; of several the one
  /// with the smallest global number; `invalid_local` if there is none.
  /// `near`: a cell to walk from, for example the one that the point was in before; it changes the time, never the
  /// result. Local. Cost: a walk, or O(log(cells)).
  LocalId find(geometry::Vec3 point, Exact<LocalId> near = invalid_local) const;

  const CellTree& tree() const { return tree_; }

 private:
  const mesh::DistMesh* mesh_;
  CellTree tree_;
};

}  // namespace pamr::locate
