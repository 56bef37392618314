// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/carried.hpp"

#include <algorithm>

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"

namespace pamr::refine {

Carried carry_over(const NumberedMesh& pass, const Carried& full, bool has_moved) {
  const auto& [mesh, closure, numbering] = pass;
  Carried carried;
  assign_array(carried.marks, at(numbering.first_child.back()), Carried::not_carried);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    if (closure.action[at(c)] == Action::split && closure.state[at(c)] == 0)
      carried.marks[at(numbering.first_child[at(c)])] = full.marks[at(c)];
  if (has_moved) return carried;
  reserve_array(carried.plans, full.plans.size());
  for (const auto& family : full.plans) {
    if (closure.action[at(family.first)] != Action::split) continue;
    carried.plans.push_back(family);
    carried.plans.back().first = numbering.first_child[at(family.first)];
  }
  return carried;
}

}  // namespace pamr::refine
