// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/refine/closure.hpp"
#include "pamr/refine/number.hpp"

namespace pamr::refine {

/// The children, not yet linked to each other.
struct Children {
  std::vector<mesh::CellNodes> cell_to_node;
  std::vector<mesh::Lineage> lineage;
  std::vector<GlobalId> cell_global;
  std::vector<SplitState> state;  ///< n_old cells: the pattern used; 0 for members of rebuilt families
  std::vector<LocalId> suspects;  ///< children so flat that their sign has to be checked exactly
};

/// Splits every cell by its marks, from constant tables; the inner diagonal of 1:8 is chosen on `node_position`, which
/// holds old and new nodes, the new ones where they are meant to lie. Local, silent.
/// Order: children of each old cell in template order, old cells ascending.
Children subdivide(const NumberedMesh& old, const std::vector<geometry::Vec3>& node_position);

/// Visits the cells of a rebuilt family in their order: `visit(child, child_state, grandchild)`, where `child` counts
/// the children of the parent and `grandchild` those of that child's own pattern.
template <class Visit>
void for_each_grandchild(const RebuiltFamily& family, Visit&& visit) {
  for (int child = 0; child < split_pattern[family.state].n_children; ++child) {
    const int state = family.child_state[at(child)];
    for (int grandchild = 0; grandchild < split_pattern[at(state)].n_children; ++grandchild)
      visit(child, state, grandchild);
  }
}

}  // namespace pamr::refine
