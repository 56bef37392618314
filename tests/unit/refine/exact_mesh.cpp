// SPDX-License-Identifier: GPL-3.0-or-later
#include "exact_mesh.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "pamr/mesh/tet.hpp"

namespace pamr::test {

namespace {

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

WholeVector difference(const WholePoint& a, const WholePoint& b) { return {a[0] - b[0], a[1] - b[1], a[2] - b[2]}; }

WholeVector cross(const WholeVector& a, const WholeVector& b) {
  return {a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]};
}

Wide dot(const WholeVector& a, const WholeVector& b) { return a[0] * b[0] + a[1] * b[1] + a[2] * b[2]; }

/// Which side of the edge from a to b the point is on, seen along the normal.
int side(const WholePoint& a, const WholePoint& b, const WholePoint& p, const WholeVector& normal) {
  const auto turn = cross(difference(b, a), difference(p, a));
  // both vectors are parallel when the point lies in the plane: one component tells the sense
  for (std::size_t i = 0; i < 3; ++i)
    if (turn[i] != 0 && normal[i] != 0) return (turn[i] > 0) == (normal[i] > 0) ? 1 : -1;
  return 0;
}

}  // namespace

std::vector<WholePoint> to_whole(const std::vector<geometry::Vec3>& point) {
  std::vector<WholePoint> whole;
  for (const auto p : point) {
    WholePoint w{};
    for (std::size_t i = 0; i < 3; ++i) {
      const double scaled = std::ldexp(i == 0 ? p.x : i == 1 ? p.y : p.z, 30);
      w[i] = static_cast<std::int64_t>(scaled);
      if (static_cast<double>(w[i]) != scaled || std::abs(scaled) > 0x1p33)
        throw std::logic_error("expected a whole multiple of 2^-30");
    }
    whole.push_back(w);
  }
  return whole;
}

Wide six_volumes(const std::vector<WholePoint>& point, const std::array<GlobalId, 4>& cell) {
  const auto& o = point[at(cell[0])];
  return dot(cross(difference(point[at(cell[1])], o), difference(point[at(cell[2])], o)),
             difference(point[at(cell[3])], o));
}

std::vector<BoundaryFace> boundary_of(const mesh::BlockMesh& whole) {
  std::vector<BoundaryFace> faces;
  for (std::size_t c = 0; c < whole.cell_to_cell.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      if (whole.cell_to_cell[c][f] >= 0) continue;
      BoundaryFace face;
      face.patch = static_cast<int>(-whole.cell_to_cell[c][f] - 1);
      for (std::size_t i = 0; i < 3; ++i) face.corner[i] = whole.cell_to_node[c][at(mesh::tet::face_to_corner[f][i])];
      faces.push_back(face);
    }
  return faces;
}

WholeVector area_vector(const std::vector<WholePoint>& point, const std::array<GlobalId, 3>& corner) {
  const auto& o = point[at(corner[0])];
  return cross(difference(point[at(corner[1])], o), difference(point[at(corner[2])], o));
}

bool lies_in(const std::array<WholePoint, 3>& inner, const std::array<WholePoint, 3>& outer) {
  const auto normal = cross(difference(outer[1], outer[0]), difference(outer[2], outer[0]));
  return std::all_of(inner.begin(), inner.end(), [&](const WholePoint& p) {
    return dot(normal, difference(p, outer[0])) == 0 && side(outer[0], outer[1], p, normal) >= 0 &&
           side(outer[1], outer[2], p, normal) >= 0 && side(outer[2], outer[0], p, normal) >= 0;
  });
}

}  // namespace pamr::test
