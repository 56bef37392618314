// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/box_of_nodes.hpp"

#include <gtest/gtest.h>

namespace pamr::mesh {
namespace box_of_nodes_test {

TEST(BoxOverRanks, IsTheSmallestAroundThoseOfAllRanks) {
  const par::Comm comm(MPI_COMM_WORLD);
  const double r = comm.rank(), n = comm.size();

  const auto box = box_over_ranks(comm, {{r, -r, 0.5 + r}, {r + 1, 2, 3 - r}});

  EXPECT_EQ(box.low, (geometry::Vec3{0, 1 - n, 0.5}));
  EXPECT_EQ(box.high, (geometry::Vec3{n, 2, 3}));
}

TEST(BoxOverRanks, TakesNothingFromRanksWithoutAny) {
  const par::Comm comm(MPI_COMM_WORLD);
  const bool is_last = comm.rank() == comm.size() - 1;

  const auto box = box_over_ranks(comm, is_last ? geometry::Box{{1, 2, 3}, {4, 5, 6}} : geometry::Box{});

  EXPECT_EQ(box.low, (geometry::Vec3{1, 2, 3}));
  EXPECT_EQ(box.high, (geometry::Vec3{4, 5, 6}));
  EXPECT_TRUE(box_over_ranks(comm, {}).is_empty());
}

TEST(BoxOfNodes, IsTheSameOnEveryRank) {
  const par::Comm comm(MPI_COMM_WORLD);
  DistMesh mesh;
  const double r = comm.rank();
  mesh.node_position = {{r, 0, 0}, {0, r + 1, -1}};

  const auto box = box_of_nodes(comm, mesh);

  EXPECT_EQ(box.low, (geometry::Vec3{0, 0, -1}));
  EXPECT_EQ(box.high, (geometry::Vec3{comm.size() - 1.0, 1.0 * comm.size(), 0}));
}

}  // namespace box_of_nodes_test
}  // namespace pamr::mesh
