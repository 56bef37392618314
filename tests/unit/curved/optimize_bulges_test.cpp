// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/curved/optimize_bulges.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "coarse_walls.hpp"
#include "pamr/base/index.hpp"
#include "support/error_of.hpp"
#include "support/meshes.hpp"

namespace pamr::curved {
namespace optimize_bulges_test {

using geometry::Vec3;
using Kind = Freedom::Kind;

/// A block of 48 cells whose top, z = 1, bulges by `height`; edges in its other faces stay in them.
test::WholeZone bulging_block(double height) {
  const auto block = test::kuhn_cube(par::Comm(MPI_COMM_SELF), 2);
  test::WholeCells cells;
  cells.node = block.node_position;
  for (const auto& nodes : block.cell_to_node)
    cells.cell.push_back({at(nodes[0]), at(nodes[1]), at(nodes[2]), at(nodes[3])});
  auto whole = test::zone_of(cells);
  for (std::size_t e = 0; e < whole.edge_to_node.size(); ++e) {
    const Vec3 a = cells.node[whole.edge_to_node[e][0]], b = cells.node[whole.edge_to_node[e][1]];
    auto& freedom = whole.zone.freedom[e];
    if (a.z == 1 && b.z == 1) {
      whole.zone.bulge[e] = {0, 0, height};
      continue;
    }
    freedom.kind = Kind::any;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      if (a[axis] != b[axis] || (a[axis] != 0 && a[axis] != 1)) continue;
      Vec3 normal;
      normal[axis] = 1;
      if (freedom.kind == Kind::in_plane)
        freedom = {Kind::along_line, cross(freedom.direction, normal)};
      else
        freedom = {Kind::in_plane, normal};
    }
  }
  return whole;
}

TEST(OptimizeBulges, UnfoldsTheCellsOfACoarseSphericalShell) {
  const auto zone = test::shell_zone();

  const auto result = optimize_bulges(par::Comm(MPI_COMM_SELF), zone);

  EXPECT_LT(result.smallest_before, -0.6);
  EXPECT_GT(result.smallest, 0.44);
  EXPECT_LE(result.iterations, 30);
  for (std::size_t e = 0; e < zone.bulge.size(); ++e)
    if (zone.freedom[e].kind == Kind::none) {
      EXPECT_EQ(result.bulge[e], zone.bulge[e]);
    }
}

TEST(OptimizeBulges, HasTheSameBitsForAnyPartitionAndNumbering) {
  const par::Comm world(MPI_COMM_WORLD);
  const auto whole = test::shell_zone();
  const auto expected = optimize_bulges(par::Comm(MPI_COMM_SELF), whole);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    // the third time the last rank has nothing
    const auto part =
        test::part_of(world, whole, seed, seed == 3 && world.size() > 1 ? world.size() - 1 : world.size());

    const auto result = optimize_bulges(world, part.zone);

    ASSERT_EQ(result.bulge.size(), part.edge_in_whole.size());
    for (std::size_t e = 0; e < result.bulge.size(); ++e)
      ASSERT_EQ(result.bulge[e], expected.bulge[at(part.edge_in_whole[e])]);
    EXPECT_EQ(result.iterations, expected.iterations);
    EXPECT_EQ(result.smallest, expected.smallest);
    EXPECT_EQ(result.smallest_before, expected.smallest_before);
  }
}

TEST(OptimizeBulges, LeavesTheEdgesBetweenStraightWallsStraight) {
  const par::Comm world(MPI_COMM_WORLD);
  const auto part = test::part_of(world, bulging_block(0).zone, 1, world.size());

  const auto result = optimize_bulges(world, part.zone);

  for (const auto& b : result.bulge) EXPECT_EQ(b, Vec3{});
  EXPECT_EQ(result.iterations, 0);
  EXPECT_EQ(result.smallest, result.smallest_before);
}

TEST(OptimizeBulges, KeepsEdgesInTheirPlanesAndLines) {
  const par::Comm world(MPI_COMM_WORLD);
  for (const double height : {0.3, -0.3}) {
    const auto part = test::part_of(world, bulging_block(height).zone, 2, world.size());

    const auto result = optimize_bulges(world, part.zone);

    EXPECT_GT(result.smallest, result.smallest_before);
    std::int64_t n_bent_in_plane = 0, n_bent_along_line = 0;
    for (std::size_t e = 0; e < result.bulge.size(); ++e) {
      const auto& freedom = part.zone.freedom[e];
      const Vec3 b = result.bulge[e];
      if (freedom.kind == Kind::in_plane) {
        EXPECT_EQ(dot(b, freedom.direction), 0);
        n_bent_in_plane += b == Vec3{} ? 0 : 1;
      } else if (freedom.kind == Kind::along_line) {
        EXPECT_EQ(cross(b, freedom.direction), Vec3{});
        n_bent_along_line += b == Vec3{} ? 0 : 1;
      }
    }
    EXPECT_GT(world.sum(n_bent_in_plane), 0);
    EXPECT_GT(world.sum(n_bent_along_line), 0);
  }
}

TEST(OptimizeBulges, RefusesFlatCellsAndWildValuesOnEveryRank) {
  const par::Comm world(MPI_COMM_WORLD);
  const auto error_with = [&](const auto& change) {
    auto part = test::part_of(world, test::shell_zone(), 1, world.size());
    if (world.rank() == world.size() - 1) change(part.zone);
    return test::error_of([&] { optimize_bulges(world, part.zone); });
  };

  EXPECT_NE(error_with([](BulgeZone& zone) {
              zone.corner[3][3] = midpoint(zone.corner[3][0], zone.corner[3][1]);
            }).find("expected cells with a volume, found mean ratio"),
            std::string::npos);
  EXPECT_NE(error_with([](BulgeZone& zone) {
              zone.walls.rows[3][7][2].y = std::numeric_limits<double>::infinity();
            }).find("expected finite derivatives"),
            std::string::npos);
  EXPECT_NE(error_with([](BulgeZone& zone) { zone.bulge[3].x = std::nan(""); }).find("expected finite bulges"),
            std::string::npos);
  EXPECT_NE(error_with([](BulgeZone& zone) { zone.walls.rows[3][7][2].y = 1e100; }).find("overflow"),
            std::string::npos);
}

}  // namespace optimize_bulges_test
}  // namespace pamr::curved
