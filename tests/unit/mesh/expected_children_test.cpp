// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/expected_children.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "pamr/adapt/forecast.hpp"
#include "pamr/assemble/kuhn_cube.hpp"

namespace pamr {
namespace {

TEST(ExpectedChildren, FollowFromTheNodesThatACellSharesWithMarkedOnes) {
  const std::vector<std::array<std::uint32_t, 4>> cells{
      {0, 1, 2, 3}, {1, 2, 3, 4}, {2, 3, 4, 5}, {3, 4, 5, 6}, {7, 8, 9, 10}};
  const std::vector<std::uint8_t> marks{1, 0, 0, 0, 0};

  EXPECT_EQ(mesh::expected_children(cells, marks), (std::vector<std::uint8_t>{8, 4, 2, 1, 1}));
}

TEST(ExpectedChildren, OfNoCellsAreNone) { EXPECT_TRUE(mesh::expected_children({}, {}).empty()); }

TEST(ExpectedChildren, ComeNearTheRefinedCube) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 12));
  std::vector<std::array<std::uint32_t, 4>> nodes;
  std::vector<std::uint8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    auto& row = nodes.emplace_back();
    for (std::size_t i = 0; i < 4; ++i)
      row[i] = static_cast<std::uint32_t>(
          mesh.node_global[static_cast<std::size_t>(mesh.cell_to_node[static_cast<std::size_t>(c)][i])]);
    const auto p = mesh.points(c)[0];
    flags.push_back(p.x * p.x + p.y * p.y + p.z * p.z < 0.16 ? 1 : 0);
  }

  const auto expected = mesh::expected_children(nodes, flags);

  const auto sum = comm.sum(std::accumulate(expected.begin(), expected.end(), std::int64_t{0}));
  const auto exact = adapt::Forecaster(comm, mesh).forecast(flags).cells;
  EXPECT_NEAR(static_cast<double>(sum), static_cast<double>(exact), 0.05 * static_cast<double>(exact));
}

}  // namespace
}  // namespace pamr
