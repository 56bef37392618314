// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/expected_work.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/forecast.hpp"
#include "pamr/assemble/kuhn_cube.hpp"

namespace pamr {
namespace expected_work_test {

using Eighths = std::vector<std::uint8_t>;

TEST(ExpectedWork, FollowsFromTheEdgesThatACellSharesWithMarkedOnes) {
  const std::vector<std::array<GlobalId, 4>> cells{
      {0, 1, 2, 3}, {1, 2, 3, 4}, {2, 3, 4, 5}, {3, 4, 5, 6}, {7, 8, 9, 10}};
  const std::vector<std::int64_t> marks{1, 0, 0, 0, 0};

  EXPECT_EQ(balance::work_from_marks(cells, marks, {}), (Eighths{64, 34, 17, 8, 8}));
}

TEST(ExpectedWork, OfAnEdgeBetweenNodesOfTwoMarkedCellsIsNone) {
  const std::vector<std::array<GlobalId, 4>> cells{{0, 1, 2, 3}, {4, 5, 6, 7}, {3, 4, 8, 9}};

  EXPECT_EQ(balance::work_from_marks(cells, std::vector<std::int64_t>{1, 1, 0}, {}), (Eighths{64, 64, 8}));
}

TEST(ExpectedWork, OfAMarkedFamilyIsThatOfOneCellSplitBefore) {
  const std::vector<std::array<GlobalId, 4>> cells{
      {0, 1, 2, 3}, {1, 2, 3, 4}, {2, 3, 4, 5}, {3, 4, 5, 6}, {4, 5, 6, 7}};
  const auto half = [](int child) { return mesh::Lineage(mesh::FamilyKind::edge, 2, child, 1); };
  // a family of two whose first cell is in the block before, one whole family, and one cell of the next
  const std::vector<mesh::Lineage> lineage{half(1), half(0), half(1), mesh::Lineage(), half(0)};

  EXPECT_EQ(balance::work_from_marks(cells, std::vector<std::int64_t>{0, 1, 0, 0, 0}, lineage),
            (Eighths{25, 40, 40, 17, 10}));
  EXPECT_EQ(balance::work_from_marks(cells, std::vector<std::int64_t>{1, 0, 0, 0, 0}, lineage),
            (Eighths{40, 25, 25, 8, 10}));
  const std::vector<mesh::Lineage> broken(5, half(0).broken());
  EXPECT_EQ(balance::work_from_marks(cells, std::vector<std::int64_t>{1, 0, 0, 0, 0}, broken),
            (Eighths{64, 34, 17, 8, 8}));
}

TEST(ExpectedWork, OfNoCellsIsNone) { EXPECT_TRUE(balance::work_from_marks({}, {}, {}).empty()); }

TEST(ExpectedWork, ComesNearTheRefinedCube) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 12));
  std::vector<std::array<GlobalId, 4>> nodes;
  std::vector<std::int64_t> marks;
  std::vector<std::uint8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    auto& row = nodes.emplace_back();
    for (std::size_t i = 0; i < 4; ++i)
      row[i] = mesh.node_global[static_cast<std::size_t>(mesh.cell_to_node[static_cast<std::size_t>(c)][i])];
    const auto p = mesh.points(c)[0];
    flags.push_back(p.x * p.x + p.y * p.y + p.z * p.z < 0.16 ? 1 : 0);
    marks.push_back(flags.back());
  }

  const auto expected = balance::work_from_marks(nodes, marks, {});

  const auto sum = comm.sum(std::accumulate(expected.begin(), expected.end(), std::int64_t{0}));
  const auto exact = adapt::Forecaster(comm, mesh).forecast(flags).cells;
  EXPECT_NEAR(static_cast<double>(sum) / 8, static_cast<double>(exact), 0.05 * static_cast<double>(exact));
}

TEST(ExpectedWork, ComesNearARefinedMeshThatIsRefinedAgain) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 10));
  const auto near_origin = [&](double radius) {
    std::vector<std::uint8_t> flags;
    for (LocalId c = 0; c < mesh.n_cells(); ++c) flags.push_back(geometry::norm(mesh.points(c)[0]) < radius ? 1 : 0);
    return flags;
  };
  mesh = adapt::refine(comm, mesh, near_origin(0.4)).mesh;
  const auto flags = near_origin(0.5);  // the closure families around what was refined before
  std::vector<std::array<GlobalId, 4>> nodes;
  for (const auto& cell : mesh.cell_to_node) {
    auto& row = nodes.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) row[i] = mesh.node_global[static_cast<std::size_t>(cell[i])];
  }

  const auto expected =
      balance::work_from_marks(nodes, std::vector<std::int64_t>(flags.begin(), flags.end()), mesh.lineage);

  const auto sum = comm.sum(std::accumulate(expected.begin(), expected.end(), std::int64_t{0}));
  const auto exact = adapt::Forecaster(comm, mesh).forecast(flags).cells;
  EXPECT_NEAR(static_cast<double>(sum) / 8, static_cast<double>(exact), 0.1 * static_cast<double>(exact));
}

TEST(ExpectedWork, OfAFieldIsItsValuesWithinTheirRange) {
  const std::vector<std::int64_t> values{-3, 0, 1, 7, 255, 256, std::int64_t{1} << 40U};

  EXPECT_EQ(balance::work_from_values(values), (std::vector<std::uint8_t>{1, 1, 1, 7, 255, 255, 255}));
}

TEST(ExpectedWork, IsAFieldBesideTheMarksOrNone) {
  mesh::DistMesh mesh;
  mesh.cell_to_node.resize(2);
  const auto values = [&] { return mesh.find_cell_field("refine_work")->integer(); };

  balance::set_work(mesh, "refine", std::vector<std::uint8_t>{8, 1});
  EXPECT_EQ(values(), (std::vector<std::int64_t>{8, 1}));
  balance::set_work(mesh, "refine", std::vector<std::uint8_t>{2, 3});
  EXPECT_EQ(values(), (std::vector<std::int64_t>{2, 3}));
  balance::set_work(mesh, "refine", std::nullopt);

  EXPECT_TRUE(mesh.cell_fields.empty());
}

TEST(ExpectedWork, BeginsTheRunsOfTheRanks) {
  const par::Comm comm(MPI_COMM_WORLD);
  const std::vector<std::uint8_t> work(static_cast<std::size_t>(10 * (comm.rank() + 1)), 3);

  const auto first = balance::first_cell_of_run(comm, work);

  const auto n = comm.sum(std::ssize(work));
  EXPECT_NEAR(static_cast<double>(first), static_cast<double>(n * comm.rank()) / comm.size(), 1);
}

}  // namespace expected_work_test
}  // namespace pamr
