// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/snap.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "meshing/sphere_in_box.hpp"
#include "pamr/base/error.hpp"

namespace pamr::meshing {
namespace snap_test {

using geometry::Vec3;

/// A tetrahedron cut into four by a node in it.
RawMesh star(Vec3 center) {
  RawMesh mesh;
  mesh.point = {{1, 1, 1}, {1, -1, -1}, {-1, 1, -1}, {-1, -1, 1}, center};
  mesh.binding.assign(5, {Freedom::none, -1});
  mesh.binding[4] = {};
  mesh.cell = {{4, 2, 1, 3}, {0, 2, 4, 3}, {0, 4, 1, 3}, {0, 2, 1, 4}};
  return mesh;
}

Domain no_surfaces() {
  Domain domain;
  domain.size = [](Vec3) { return 1.0; };
  return domain;
}

TEST(Improve, MovesAnInnerNodeUntilItsWorstCellIsGood) {
  auto mesh = star({0.32, 0.31, -0.31});

  const auto done = improve(no_surfaces(), mesh, {.wanted = 0.4, .required = 0.3});

  EXPECT_LT(done.min_before, 0.2);
  EXPECT_GE(done.min_after, 0.4);
  EXPECT_GT(done.moves, 0);
  EXPECT_EQ(mesh.point[0], (Vec3{1, 1, 1}));
}

TEST(Improve, LeavesAGoodMeshAlone) {
  auto mesh = star({0, 0, 0});

  const auto done = improve(no_surfaces(), mesh);

  EXPECT_EQ(done.moves, 0);
  EXPECT_EQ(done.min_before, done.min_after);
  EXPECT_EQ(mesh.point[4], (Vec3{0, 0, 0}));
}

TEST(Improve, RefusesAMeshThatStaysBad) {
  auto mesh = star({0.32, 0.31, -0.31});
  mesh.binding[4].freedom = Freedom::none;

  EXPECT_THAT([&] { improve(no_surfaces(), mesh); },
              testing::ThrowsMessage<Error>(testing::HasSubstr("expected cells of mean ratio 0.2 or more")));
}

TEST(Improve, RefusesAnInvertedCell) {
  auto mesh = star({0, 0, 0});
  mesh.binding[4].freedom = Freedom::none;
  std::swap(mesh.cell[2][0], mesh.cell[2][1]);

  EXPECT_THROW(improve(no_surfaces(), mesh), Error);
}

TEST(PlaceBoundary, PutsNodesOnTheirPieceAndCurve) {
  const auto domain = sphere_in_box(0.3);
  RawMesh mesh;
  mesh.point = {{0.1, 0.2, 1.1}, {1.9, 0.5, 0.25}, {0.5, 1.95, 2.1}, {0.7, 0.7, 0.7}, {2, 2, 2}};
  mesh.binding = {{Freedom::piece, 6}, {Freedom::piece, 1}, {Freedom::curve, 3}, {}, {Freedom::none, -1}};

  const double farthest = place_boundary(domain, mesh);

  EXPECT_NEAR(norm(mesh.point[0]), 1, 2e-16);
  EXPECT_EQ(mesh.point[1], (Vec3{2, 0.5, 0.25}));
  EXPECT_EQ(mesh.point[2], (Vec3{0.5, 2, 2}));
  EXPECT_EQ(mesh.point[3], (Vec3{0.7, 0.7, 0.7}));
  EXPECT_EQ(mesh.point[4], (Vec3{2, 2, 2}));
  EXPECT_NEAR(farthest, norm(Vec3{0.1, 0.2, 1.1}) - 1, 1e-15);
}

}  // namespace snap_test
}  // namespace pamr::meshing
