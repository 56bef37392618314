// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "pamr/coarsen/octets.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::coarsen {

/// Which cells of the coarse mesh old cells are, or are replaced by.
struct NewPlaces {
  /// n_cells: the new local number of a cell that stays as it is; of a group's cell -1 - the group's number.
  std::vector<LocalId> cell;
  std::vector<LocalId> first_of_group;  ///< new local number of the first cell that takes the place of each group

  bool is_in_group(LocalId old_cell) const { return cell[at(old_cell)] < 0; }
  /// Pre: it is in one.
  std::size_t group_of(LocalId old_cell) const { return at(-1 - cell[at(old_cell)]); }
};

/// Fills the neighbors and the rank border of `coarse`, whose cells, nodes and numbers are there. Links between cells
/// that stay are handed on; faces at groups are matched by their nodes with those of what the old links lead to, those
/// on the rank border by the global numbers of theirs. `groups`: ascending, those of `places`. Throws `Error` on every
/// rank where a face finds no other side, as in meshes whose lineage was not made by refining. Collective: one sparse
/// exchange of 32 bytes a border face. Cost: O(cells).
void link_coarse(const par::Comm& comm, const mesh::DistMesh& old, std::span<const Group> groups,
                 const NewPlaces& places, mesh::DistMesh& coarse);

}  // namespace pamr::coarsen
