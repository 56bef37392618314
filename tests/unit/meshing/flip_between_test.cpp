// SPDX-License-Identifier: GPL-3.0-or-later
// Two pyramids on the two triangulations of one square, and the cell between these: nodes 0 to 3 around the middle, 4
// above, 5 below.
#include "meshing/flip_between.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <utility>
#include <vector>

#include "meshing/ears.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"

namespace pamr::meshing {
namespace flip_between_test {

using geometry::Vec3;
using Cell = std::array<std::int32_t, 4>;

/// Nodes 0 and 1 at the height `low`, 2 and 3 at `high`; the cell between is number 2, of region 0 above.
RawMesh two_pyramids(double low, double high) {
  RawMesh mesh;
  mesh.point = {{0.5, 0, low}, {-0.5, 0, low}, {0, 0.5, high}, {0, -0.5, high}, {0, 0, 0.7}, {0, 0, -0.7}};
  mesh.binding.assign(6, {Freedom::piece, 0});
  mesh.binding[4] = mesh.binding[5] = {};
  mesh.cell = {{0, 2, 3, 4}, {1, 2, 3, 4}, {0, 1, 2, 3}, {0, 1, 2, 5}, {0, 1, 3, 5}};
  mesh.region = {0, 0, 0, 1, 1};
  auto flexed = mesh.point;  // the cell between has a side above and a side below where it is flat, too
  flexed[2].z = flexed[3].z = std::max(high, low + 0.01);
  std::map<LocalFace, std::vector<BoundaryFace>> cells_of_face;
  for (std::size_t c = 0; c < mesh.cell.size(); ++c) {
    auto& node = mesh.cell[c];
    if (geometry::volume({flexed[at(node[0])], flexed[at(node[1])], flexed[at(node[2])], flexed[at(node[3])]}) < 0)
      std::swap(node[0], node[1]);
    const auto cell = static_cast<std::int32_t>(c);
    for (int slot = 0; slot < 4; ++slot) cells_of_face[face_of(mesh, cell, slot)].push_back({cell, slot, 1});
  }
  for (const auto& [face, cells] : cells_of_face)
    if (cells.size() == 1)
      mesh.face.push_back(cells[0]);
    else if (mesh.region[at(cells[0].cell)] != mesh.region[at(cells[1].cell)])
      mesh.between.push_back({cells[0].cell, cells[0].slot, 0});
  return mesh;
}

/// The regions meet in z = a x^2 + b y^2.
Domain bent(double a, double b) {
  Domain domain;
  const auto height = [=](Vec3 p) { return a * p.x * p.x + b * p.y * p.y; };
  domain.label = [=](Vec3 p) { return Domain::in_region(p.z < height(p) ? 1 : 0); };
  domain.regions = {{"above", 0}, {"below", 0}};
  domain.pieces.push_back({0, [=](Vec3 p) { return Vec3{p.x, p.y, height(p)}; }, {}, {0, 1}});
  domain.pieces.push_back({1, [](Vec3 p) { return p; }});
  return domain;
}

std::set<LocalFace> nodes_of(const RawMesh& mesh, const std::vector<BoundaryFace>& faces) {
  std::set<LocalFace> result;
  for (const auto& face : faces) result.insert(face_of(mesh, face.cell, face.slot));
  return result;
}

void expect_to_fill_the_pyramids(const RawMesh& mesh) {
  double volume = 0;
  for (std::size_t c = 0; c < mesh.cell.size(); ++c) {
    EXPECT_GT(geometry::mean_ratio(mesh.points(c)), 0.4);
    volume += geometry::volume(mesh.points(c));
  }
  EXPECT_NEAR(volume, 1.4 / 6, 1e-15);
  EXPECT_EQ(mesh.face.size(), 8U);
  EXPECT_EQ(nodes_of(mesh, mesh.face).size(), 8U);
  for (const auto& face : mesh.between) EXPECT_EQ(mesh.region[at(face.cell)], 0);
}

TEST(FlipBetween, AFlatCellGoesAndTheCellsBesideItAreMadeAnew) {
  auto mesh = two_pyramids(0, 0);
  ASSERT_EQ(mesh.between.size(), 2U);

  EXPECT_EQ(flip_between(bent(0, 0), mesh), 1);

  EXPECT_EQ(mesh.cell.size(), 4U);
  EXPECT_EQ(std::count(mesh.region.begin(), mesh.region.end(), 0), 2);
  EXPECT_EQ(nodes_of(mesh, mesh.between), (std::set<LocalFace>{{0, 1, 2}, {0, 1, 3}}));
  expect_to_fill_the_pyramids(mesh);
}

TEST(FlipBetween, ACellBehindACurvedFaceGoesToTheRegionThere) {
  auto mesh = two_pyramids(-0.25, -0.125);

  EXPECT_EQ(flip_between(bent(-1, -0.5), mesh), 1);

  EXPECT_EQ(mesh.region, (std::vector<int>{0, 0, 1, 1, 1}));
  EXPECT_EQ(nodes_of(mesh, mesh.between), (std::set<LocalFace>{{0, 2, 3}, {1, 2, 3}}));
  expect_to_fill_the_pyramids(mesh);
}

TEST(FlipBetween, LeavesTheCellsOfAHollowFace) {
  auto mesh = two_pyramids(0.125, 0.25);
  const auto before = mesh.cell;

  EXPECT_EQ(flip_between(bent(0.5, 1), mesh), 0);

  EXPECT_EQ(mesh.cell, before);
}

}  // namespace flip_between_test
}  // namespace pamr::meshing
