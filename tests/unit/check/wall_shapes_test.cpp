// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/wall_shapes.hpp"

#include <gtest/gtest.h>

#include <memory>
#include <string>

#include "pamr/assemble/assemble.hpp"
#include "pamr/geometry/surface_toml.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace wall_shapes_test {

using check::WallShapes;

/// A right corner (mean ratio 0.84), and below it two flat cells of the same shape (0.27), mirrored at x = 0.
mesh::DistMesh three_cells(const par::Comm& comm, const std::string& surface) {
  auto mesh = assemble::assemble(
      comm, test::small_mesh(comm, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {0, 0, -0.1}, {-1, 0, 0}},
                             {{0, 1, 2, 3}, {0, 2, 1, 4}, {0, 5, 2, 4}}));
  mesh.info.surfaces = std::make_shared<const geometry::SurfaceSet>(
      geometry::surfaces_from_toml("[[surface]]\nname = \"wall\"\n" + surface, "test"));
  mesh.info.patches[0].surface = 0;
  return mesh;
}

TEST(WallShapes, TellsTheWorstCellAndHowManyAreBelowALimit) {
  const par::Comm world(MPI_COMM_WORLD);
  const auto mesh = three_cells(world, "kind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 1\n");

  const auto shapes = check::wall_shapes(world, mesh, 0.5);

  EXPECT_NEAR(shapes.smallest, 0.2701, 1e-4);
  EXPECT_EQ(shapes.where, (geometry::Vec3{-0.25, 0.25, -0.025}));
  EXPECT_EQ(shapes.n_below, 2);
  EXPECT_EQ(check::wall_shapes(world, mesh, 0.27).n_below, 0);
  EXPECT_EQ(check::wall_shapes(world, mesh, 0.9).n_below, 3);
}

TEST(WallShapes, FlatWallsAreNoMatter) {
  const par::Comm world(MPI_COMM_WORLD);
  const auto mesh = three_cells(world, "kind = \"plane\"\npoint = [0, 0, 0]\nnormal = [0, 0, 1]\n");

  EXPECT_EQ(check::wall_shapes(world, mesh, 0.5), WallShapes());
}

TEST(WallShapes, WhatSplittingAloneCanMakeIsNoLoss) {
  WallShapes before;
  before.smallest = 0.36;
  EXPECT_EQ(check::limit_of_lost_shape(before), 0.2);
  before.smallest = 0.1;
  EXPECT_DOUBLE_EQ(check::limit_of_lost_shape(before), 0.07);
}

}  // namespace wall_shapes_test
}  // namespace pamr
