// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/shape_bound.hpp"

#include <algorithm>
#include <span>

#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/families.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/mesh/uniform_shape.hpp"

namespace pamr::check {

double worst_uniform_shape(const par::Comm& comm, const mesh::DistMesh& mesh) {
  const mesh::Level0View level0(mesh);
  double worst = 1;
  for (LocalId c = 0; c < mesh.n_cells();) {
    const auto lineage = mesh.lineage[at(c)];
    const int size = lineage.is_removable() && lineage.child() == 0 ? lineage.family_size() : 1;
    if (level0.row_of(c) >= 0) {  // what comes of it is not straight
      c += size;
      continue;
    }
    if (size == 1 || c + size > mesh.n_cells()) {
      worst = mesh::worst_uniform_shape(mesh.points(c++), worst);
      continue;
    }
    const auto family = std::span<const mesh::CellNodes>(mesh.cell_to_node).subspan(at(c), at(size));
    geometry::TetPoints corner;
    const auto parent = mesh::parent_corners<LocalId>(lineage, family);
    std::transform(parent.begin(), parent.end(), corner.begin(), [&](LocalId node) { return mesh.point(node); });
    worst = mesh::worst_uniform_shape(corner, worst);
    c += size;
  }
  return comm.min(worst);
}

ShapeBound shape_bound(const par::Comm& comm, const mesh::DistMesh& mesh, double shape_floor) {
  double closed = shape_floor;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    if (mesh.lineage[at(c)].is_closure()) closed = std::min(closed, geometry::mean_ratio(mesh.points(c)));
  ShapeBound bound;
  bound.of_uniform_levels = worst_uniform_shape(comm, mesh);
  bound.of_all_levels = std::min(comm.min(closed), bound.of_uniform_levels);
  return bound;
}

}  // namespace pamr::check
