// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/locate/walk.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "pamr/base/index.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/geometry/tet_shape.hpp"

namespace pamr::locate {

namespace {

/// The four sides of a cell: of face i the sign of the volume that the cell has with the point in place of corner i.
std::array<int, 4> sides(const geometry::TetPoints& p, geometry::Vec3 x) {
  return {geometry::orientation(x, p[1], p[2], p[3]), geometry::orientation(p[0], x, p[2], p[3]),
          geometry::orientation(p[0], p[1], x, p[3]), geometry::orientation(p[0], p[1], p[2], x)};
}

/// The face with the most negative part of the cell's volume, of those that part the point from the cell.
int worst_face(const geometry::TetPoints& p, geometry::Vec3 x, const std::array<int, 4>& side) {
  int worst = -1;
  double least = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    if (side[i] >= 0) continue;
    auto q = p;
    q[i] = x;
    const double volume = geometry::volume(q);
    if (worst < 0 || volume < least) {
      worst = static_cast<int>(i);
      least = volume;
    }
  }
  return worst;
}

}  // namespace

int side_of_cell(const mesh::DistMesh& mesh, Exact<LocalId> cell, geometry::Vec3 point) {
  const auto side = sides(mesh.points(cell), point);
  return *std::min_element(side.begin(), side.end());
}

WalkEnd walk_towards(const mesh::DistMesh& mesh, Exact<LocalId> start, geometry::Vec3 point) {
  // A walk through n cells crosses some n^(1/3) of them; one of many times that goes around in a circle.
  constexpr int fewest = 64;
  const int most = fewest + static_cast<int>(8 * std::cbrt(static_cast<double>(mesh.n_cells())));
  LocalId cell = start;
  for (int step = 0; step < most; ++step) {
    const auto p = mesh.points(cell);
    const auto side = sides(p, point);
    const int least = *std::min_element(side.begin(), side.end());
    if (least >= 0) return {least > 0 ? WalkEnd::At::cell : WalkEnd::At::corner, cell, 0};
    const int face = worst_face(p, point, side);
    const auto next = mesh.cell_to_cell[at(cell)][at(face)];
    if (next < 0) return {WalkEnd::At::boundary, cell, face};
    if (mesh.is_ghost(next)) return {WalkEnd::At::rank, cell, face};
    cell = next;
  }
  return {};
}

}  // namespace pamr::locate
