// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/round_bodies.hpp"

#include <fmt/format.h>

#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "pamr/geometry/tet_shape.hpp"
#include "support/meshes.hpp"

namespace pamr::test {

namespace {

using geometry::Vec3;
using Cells = std::vector<std::array<GlobalId, 4>>;

/// The mesh with its cells turned so that they are positive, and its wall on the surface.
mesh::BlockMesh on_surface(const par::Comm& comm, const std::vector<Vec3>& nodes, Cells cells,
                           const std::string& surface) {
  for (auto& n : cells) {
    geometry::TetPoints p{};
    for (std::size_t i = 0; i < 4; ++i) p[i] = nodes[static_cast<std::size_t>(n[i])];
    if (geometry::volume(p) < 0) std::swap(n[2], n[3]);
  }
  auto block = small_mesh(comm, nodes, std::move(cells));
  block.info.surfaces = surfaces_of("[[surface]]\nname = \"wall\"\n" + surface);
  block.info.patches[0].surface = 0;
  return block;
}

/// Of a sphere through the corners of the unit square that is highest above its middle.
double radius_of_dome(double bulge) { return (0.5 + bulge * bulge) / (2 * bulge); }

}  // namespace

mesh::BlockMesh ball(const par::Comm& comm) {
  const double g = std::numbers::phi, r = std::sqrt(1 + g * g);
  std::vector<Vec3> nodes{{0, 0, 0}};
  for (const double a : {-1.0, 1.0})
    for (const double b : {-g, g}) {
      nodes.push_back({0, a / r, b / r});
      nodes.push_back({a / r, b / r, 0});
      nodes.push_back({b / r, 0, a / r});
    }
  // the corners of a face are neighbors of one another
  const auto are_near = [&](std::size_t i, std::size_t j) { return norm(nodes[i] - nodes[j]) < 2.2 / r; };
  Cells cells;
  for (std::size_t i = 1; i < nodes.size(); ++i)
    for (std::size_t j = i + 1; j < nodes.size(); ++j)
      for (std::size_t k = j + 1; k < nodes.size(); ++k)
        if (are_near(i, j) && are_near(j, k) && are_near(i, k))
          cells.push_back({0, static_cast<GlobalId>(i), static_cast<GlobalId>(j), static_cast<GlobalId>(k)});
  return on_surface(comm, nodes, cells, "kind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n");
}

mesh::BlockMesh solid_torus(const par::Comm& comm, int n_sections) {
  constexpr int n_around = 6, per_section = n_around + 1;
  const double pi = std::numbers::pi, tube = 0.4;
  std::vector<Vec3> nodes;
  for (int s = 0; s < n_sections; ++s)
    for (int k = 0; k < per_section; ++k) {  // the first one is the center of the section
      const double angle = 2 * pi * s / n_sections, across = 2 * pi * k / n_around, off = k == 0 ? 0 : tube;
      const double distance = 1 + off * std::cos(across);
      nodes.push_back({distance * std::cos(angle), distance * std::sin(angle), off * std::sin(across)});
    }
  Cells cells;
  for (int s = 0; s < n_sections; ++s)
    for (int k = 1; k <= n_around; ++k) {
      // a prism between two sections, cut along the diagonals that go up from the lower number
      const int low = std::min(k, k % n_around + 1), high = std::max(k, k % n_around + 1);
      const GlobalId here = s * per_section, next = (s + 1) % n_sections * per_section;
      cells.push_back({here, here + low, here + high, next + high});
      cells.push_back({here, here + low, next + low, next + high});
      cells.push_back({here, next, next + low, next + high});
    }
  return on_surface(comm, nodes, cells,
                    fmt::format("kind = \"torus\"\ncenter = [0, 0, 0]\naxis = [0, 0, 1]\nmajor_radius = 1\n"
                                "minor_radius = {}\n",
                                tube));
}

mesh::BlockMesh tetrahedral_shell(const par::Comm& comm, double outer) {
  const double r = 1 / std::sqrt(3);
  const std::vector<Vec3> corner{{r, r, r}, {r, -r, -r}, {-r, r, -r}, {-r, -r, r}};
  auto nodes = corner;
  for (const auto p : corner) nodes.push_back(outer * p);
  Cells cells;
  mesh::BoundaryTriangles hole;
  for (GlobalId k = 0; k < 4; ++k) {  // a prism on each face of the hole, whose corners ascend
    std::array<GlobalId, 3> face{};
    for (GlobalId i = 0, n = 0; i < 4; ++i)
      if (i != k) face[static_cast<std::size_t>(n++)] = i;
    const auto [a, b, c] = face;
    cells.push_back({a, b, c, c + 4});
    cells.push_back({a, b, b + 4, c + 4});
    cells.push_back({a, a + 4, b + 4, c + 4});
    hole.node.push_back(face);
    hole.patch.push_back(0);
  }
  auto block = on_surface(comm, nodes, cells, "kind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n");
  if (comm.is_first()) block.boundary = hole;
  return block;
}

mesh::BlockMesh bulging_cube(const par::Comm& comm, std::uint64_t seed, double bulge) {
  auto block = random_mesh(comm, seed, 3);
  const double radius = radius_of_dome(bulge);
  block.info.surfaces =
      surfaces_of(fmt::format("[[surface]]\nname = \"dome\"\nkind = \"sphere\"\ncenter = [0.5, 0.5, {}]\nradius = {}\n",
                              bulge - radius, radius));
  for (auto& patch : block.info.patches)
    if (patch.name == "zmin") patch.surface = 0;
  return block;
}

mesh::BlockMesh domed_cube(const par::Comm& comm, std::uint64_t seed, double bulge) {
  auto block = bulging_cube(comm, seed, bulge);
  const double radius = radius_of_dome(bulge);
  for (auto& p : block.node_position) {
    const double x = p.x - 0.5, y = p.y - 0.5;
    p.z += (1 - p.z) * (std::sqrt(radius * radius - x * x - y * y) + bulge - radius);
  }
  return block;
}

}  // namespace pamr::test
