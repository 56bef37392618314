// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/order_raw_mesh.hpp"

#include <gtest/gtest.h>

namespace pamr::meshing {
namespace order_raw_mesh_test {

/// Two cells that share a face, the far one first, nodes in no order.
RawMesh two_cells() {
  RawMesh mesh;
  mesh.point = {{9, 9, 9}, {0, 0, 1}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}};
  mesh.binding.assign(5, {});
  mesh.binding[4] = {Freedom::curve, 7};
  mesh.cell = {{1, 3, 2, 0}, {4, 2, 3, 1}};
  mesh.face = {{1, 0, 5}, {0, 3, 6}, {0, 1, 4}};
  return mesh;
}

TEST(Ordered, NumbersNodesAsTheCellsNameThem) {
  const auto mesh = ordered(two_cells());

  ASSERT_EQ(mesh.cell.size(), 2U);
  EXPECT_EQ(mesh.cell[0], (std::array<std::int32_t, 4>{0, 1, 2, 3}));
  EXPECT_EQ(mesh.cell[1], (std::array<std::int32_t, 4>{3, 2, 1, 4}));
  EXPECT_EQ(mesh.point[0], (geometry::Vec3{0, 0, 0}));
  EXPECT_EQ(mesh.point[4], (geometry::Vec3{9, 9, 9}));
  EXPECT_EQ(mesh.binding[0].freedom, Freedom::curve);
  EXPECT_EQ(mesh.binding[0].number, 7);
}

TEST(Ordered, KeepsFacesWithTheirCells) {
  const auto mesh = ordered(two_cells());

  ASSERT_EQ(mesh.face.size(), 3U);
  EXPECT_EQ(mesh.face[0].cell, 0);
  EXPECT_EQ(mesh.face[0].piece, 5);
  EXPECT_EQ(mesh.face[1].cell, 1);
  EXPECT_EQ(mesh.face[1].slot, 1);
  EXPECT_EQ(mesh.face[1].piece, 4);
  EXPECT_EQ(mesh.face[2].slot, 3);
}

}  // namespace order_raw_mesh_test
}  // namespace pamr::meshing
