// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/refine/closure.hpp"
#include "pamr/refine/number.hpp"

namespace pamr::refine {

/// What is known of a mesh from closing the one that it came from by an early pass: the cells that the pass did not
/// change have at least the marks that they had. Empty: nothing is known.
struct Carried {
  std::vector<EdgeMask> marks;       ///< n_cells: of cells that were there before; `not_carried` for new ones
  std::vector<RebuiltFamily> plans;  ///< of families that were there before, for these marks; ascending
  static constexpr EdgeMask not_carried = 0x40;

  bool is_new(LocalId cell) const { return marks[at(cell)] == not_carried; }
};

/// `pass`: the old mesh and what the early pass did to it; `full`: marks and plans of its closure with all requests.
/// Nothing can be carried where families had to be retained. `has_moved`: the pass moved nodes that were there before,
/// so plans are made anew. Local.
Carried carry_over(const NumberedMesh& pass, const Carried& full, bool has_moved);

}  // namespace pamr::refine
