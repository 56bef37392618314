// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <limits>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/locate/locate_points.hpp"
#include "support/dice.hpp"
#include "support/meshes.hpp"

namespace pamr::locate {
namespace locate_test {

using geometry::Vec3;

/// The slow way: the first cell of the whole mesh that holds the point.
GlobalId cell_of(const mesh::BlockMesh& whole, Vec3 x) {
  for (std::size_t c = 0; c < whole.cell_to_node.size(); ++c) {
    std::array<Vec3, 4> p;
    for (std::size_t i = 0; i < 4; ++i) p[i] = whole.node_position[std::size_t(whole.cell_to_node[c][i])];
    bool holds = true;
    for (std::size_t i = 0; i < 4; ++i) {
      auto q = p;
      q[i] = x;
      holds = holds && geometry::orientation(q[0], q[1], q[2], q[3]) >= 0;
    }
    if (holds) return static_cast<GlobalId>(c);
  }
  return invalid_global;
}

/// Points inside cells, on nodes, edges and faces, and outside; others on each rank.
std::vector<Vec3> points_for(const par::Comm& comm, const mesh::BlockMesh& whole) {
  test::Dice dice(11 + std::uint64_t(comm.rank()));
  const auto node = [&] { return whole.node_position[dice.below(whole.node_position.size())]; };
  std::vector<Vec3> points;
  for (int i = 0; i < 60; ++i) {
    points.push_back({dice.unit(), dice.unit(), dice.unit()});
    points.push_back(node());
    points.push_back({1.5 * dice.symmetric(), 1.5 * dice.symmetric(), dice.unit()});
    const auto& corners = whole.cell_to_node[dice.below(whole.cell_to_node.size())];
    points.push_back(
        geometry::midpoint(whole.node_position[std::size_t(corners[0])], whole.node_position[std::size_t(corners[1])]));
  }
  return points;
}

TEST(LocatePoints, FindsTheFirstCellThatHoldsEachPointWhereverItIs) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = test::random_mesh(comm, 5, 3);
  const auto whole = test::gather(comm, block);
  const auto mesh = assemble::assemble(comm, block, test::random_destinations(comm, block, 6));
  const Locator locator(mesh);
  const auto points = points_for(comm, whole);
  test::Dice dice(3);
  std::vector<LocalId> near;
  for (std::size_t i = 0; i < points.size(); ++i)
    near.push_back(mesh.n_cells() > 0 && dice.below(4) > 0 ? LocalId(dice.below(std::size_t(mesh.n_cells())))
                                                           : invalid_local);

  const auto found = locate_points(comm, mesh, locator, points);
  const auto walked = locate_points(comm, mesh, locator, points, near);

  ASSERT_EQ(found.cell.size(), points.size());
  EXPECT_EQ(walked.cell, found.cell);
  EXPECT_EQ(walked.rank, found.rank);
  std::int64_t n_inside = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_EQ(found.cell[i], cell_of(whole, points[i])) << points[i].x << ' ' << points[i].y << ' ' << points[i].z;
    EXPECT_EQ(found.rank[i] >= 0, found.cell[i] != invalid_global);
    n_inside += found.cell[i] != invalid_global ? 1 : 0;
  }
  EXPECT_GT(n_inside, 150);
  EXPECT_LT(n_inside, std::ssize(points));
}

TEST(LocatePoints, TakesPointsThatAreNoNumbersAndEmptyLists) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 1));
  const Locator locator(mesh);
  constexpr double nan = std::numeric_limits<double>::quiet_NaN(), infinity = std::numeric_limits<double>::infinity();
  std::vector<Vec3> points;
  if (comm.is_first()) points = {{nan, 0, 0}, {infinity, 0, 0}, {0.5, 0.5, 0.5}};

  const auto found = locate_points(comm, mesh, locator, points);

  if (comm.is_first()) {
    EXPECT_THAT(found.cell, testing::ElementsAre(invalid_global, invalid_global, 0));
  }
  const std::vector<LocalId> one{0};
  EXPECT_THROW(locate_points(comm, mesh, locator, points, comm.is_first() ? one : std::vector<LocalId>()), Error);
}

TEST(WalkTowards, EndsInTheCellAtTheBoundaryOrAtARankBorder) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 4));
  test::Dice dice(4);
  std::array<int, 4> n{};
  for (int i = 0; i < 300; ++i) {
    const auto start = LocalId(dice.below(std::size_t(mesh.n_cells())));
    const Vec3 point{2 * dice.unit() - 0.5, dice.unit(), dice.unit()};
    const auto end = walk_towards(mesh, start, point);
    ASSERT_NE(end.at, WalkEnd::At::nowhere);
    if (end.at == WalkEnd::At::cell) {
      EXPECT_EQ(side_of_cell(mesh, end.cell, point), 1);
      ++n[0];
      continue;
    }
    EXPECT_EQ(side_of_cell(mesh, end.cell, point), -1);
    const auto slot = mesh.cell_to_cell[std::size_t(end.cell)][std::size_t(end.slot)];
    if (end.at == WalkEnd::At::boundary) {
      EXPECT_LT(slot, 0);
      ++n[1];
    }
    if (end.at == WalkEnd::At::rank) {
      EXPECT_TRUE(mesh.is_ghost(slot));
      ++n[2];
    }
  }
  EXPECT_GT(n[0], 0);
  EXPECT_GT(n[1], 0);
  EXPECT_EQ(n[2] > 0, comm.size() > 1);
}

}  // namespace locate_test
}  // namespace pamr::locate
