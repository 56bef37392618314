// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/gas_domain.hpp"

#include <algorithm>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/inner_patches.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

/// Plane through three nodes taken in the order of their global numbers, turned towards the outside of the cell.
struct Plane {
  Vec3 normal;
  double offset = 0;
};
Plane plane_of_face(const mesh::DistMesh& mesh, double unit, LocalId cell, int slot) {
  const auto& nodes = mesh.cell_to_node[at(cell)];
  const auto& face = mesh::tet::face_to_corner[at(slot)];
  std::array<LocalId, 3> node{};
  for (std::size_t k = 0; k < 3; ++k) node[k] = nodes[at(face[k])];
  bool odd = false;
  const auto order = [&](std::size_t i, std::size_t j) {
    if (mesh.node_global[at(node[i])] <= mesh.node_global[at(node[j])]) return;
    std::swap(node[i], node[j]);
    odd = !odd;
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  const Vec3 a = unit * mesh.point(node[0]), b = unit * mesh.point(node[1]), c = unit * mesh.point(node[2]);
  Vec3 normal = cross(b - a, c - a);
  normal = (1 / norm(normal)) * normal;
  double offset = dot(normal, a);
  if (odd) {
    normal = -normal;
    offset = -offset;
  }
  return {normal, offset};
}

}  // namespace

TetPoints corners(const mesh::DistMesh& mesh, double unit, LocalId cell) {
  auto points = mesh.points(cell);
  for (auto& p : points) p = unit * p;
  return points;
}

std::vector<GlobalId> cells_from_0(const mesh::DistMesh& mesh) {
  auto numbers = mesh.cell_global;
  for (auto& number : numbers) number -= mesh.info.first_id;
  return numbers;
}

GasDomain make_gas_domain(const mesh::DistMesh& mesh, double unit, double dt, double fnum,
                          std::span<const InnerWall> walls) {
  GasDomain domain;
  const mesh::InnerPatches inner(mesh);
  const auto n = at(mesh.n_cells());
  assign_array(domain.planes, n, CellPlanes{});
  domain.link = copy_array(mesh.cell_to_cell, n);
  assign_array(domain.volume, n, 0.0);
  assign_array(domain.dt, n, dt);
  assign_array(domain.fnum, n, fnum);
  domain.cell_global = cells_from_0(mesh);
  domain.border_rank = mesh.border_rank;
  domain.border_offset = mesh.border_offset;
  domain.border_face = mesh.border_face;
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto c = at(cell);
    const auto points = corners(mesh, unit, cell);
    domain.volume[c] = geometry::volume(points);
    for (int slot = 0; slot < 4; ++slot) {
      const auto f = at(slot);
      const auto plane = plane_of_face(mesh, unit, cell, slot);
      domain.planes[c].nx[f] = plane.normal.x;
      domain.planes[c].ny[f] = plane.normal.y;
      domain.planes[c].nz[f] = plane.normal.z;
      domain.planes[c].d[f] = plane.offset;
      auto& link = domain.link[c][f];
      const auto* wall = link < 0 || walls.empty() ? nullptr : find_wall(walls, inner.of({cell, slot}));
      if (link >= 0 && wall == nullptr) continue;
      const auto& corner = mesh::tet::face_to_corner[f];
      BoundaryFace face{cell, slot, 0, 0, plane.normal, {}, -1};
      for (std::size_t k = 0; k < 3; ++k) face.corner[k] = points[at(corner[k])];
      face.patch = wall == nullptr ? mesh::slot_to_patch(link) : wall->side_of(face.normal, face.center());
      face.area = 0.5 * norm(cross(face.corner[1] - face.corner[0], face.corner[2] - face.corner[0]));
      domain.boundary.push_back(face);
      link = -static_cast<LocalId>(domain.boundary.size());
    }
  }
  return domain;
}

bool is_inside(const GasDomain& domain, LocalId cell, Vec3 position, double tolerance) {
  for (int slot = 0; slot < 4; ++slot)
    if (domain.planes[at(cell)].depth(slot, position) < -tolerance) return false;
  return true;
}

}  // namespace pamr::dsmc
