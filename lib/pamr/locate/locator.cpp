// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/locate/locator.hpp"

#include <cmath>

namespace pamr::locate {

LocalId Locator::find(geometry::Vec3 point, Exact<LocalId> near) const {
  if (!std::isfinite(point.x) || !std::isfinite(point.y) || !std::isfinite(point.z)) return invalid_local;
  if (near >= 0 && near < mesh_->n_cells()) {
    const auto end = walk_towards(*mesh_, near, point);
    if (end.at == WalkEnd::At::cell) return end.cell;  // elsewhere other cells may hold it
  }
  LocalId found = invalid_local;  // cells ascend in global number
  tree_.for_each_near(point, [&](LocalId cell) {
    if ((found == invalid_local || cell < found) && side_of_cell(*mesh_, cell, point) >= 0) found = cell;
  });
  return found;
}

}  // namespace pamr::locate
