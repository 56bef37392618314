// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/order/order_along_curve.hpp"
#include "pamr/order/route.hpp"
#include "pamr/validate/validate.hpp"
#include "support/meshes.hpp"

namespace pamr::order {
namespace order_test {

/// Fields that tell where a cell and a node come from.
mesh::BlockMesh with_fields(const par::Comm& comm, mesh::BlockMesh block) {
  std::vector<std::int64_t> number(block.cell_to_node.size());
  std::iota(number.begin(), number.end(), block.first_cell);
  std::vector<double> twice;
  for (const auto n : number) twice.insert(twice.end(), {2.0 * static_cast<double>(n), 0.5});
  block.cell_fields.push_back({"number", "", 1, mesh::StorageType::int64, number});
  block.cell_fields.push_back({"twice", "", 2, mesh::StorageType::float64, twice});
  number.resize(block.node_position.size());
  std::iota(number.begin(), number.end(), par::block_range(block.info.node_ids(), comm.rank(), comm.size()).begin);
  block.node_fields.push_back({"node", "", 1, mesh::StorageType::int64, number});
  return block;
}

/// `n` cubes in a row, apart from each other, of 6 cells round their diagonal each, all of them split 1:2 on it:
/// nothing but closure families.
mesh::BlockMesh row_of_families(const par::Comm& comm, int n) {
  const par::Comm self(MPI_COMM_SELF);
  mesh::BlockMesh whole;
  whole.info.patches = {{"wall", "patch"}};
  const auto cube = assemble::kuhn_cube(self, 1);
  for (int k = 0; k < n; ++k) {
    const auto first_node = static_cast<GlobalId>(whole.node_position.size());
    for (const auto p : cube.node_position) whole.node_position.push_back(p + geometry::Vec3{2.0 * k, 0, 0});
    whole.node_position.push_back({2.0 * k + 0.5, 0.5, 0.5});
    for (const auto& nodes : cube.cell_to_node) {
      std::size_t a = 4, b = 4;
      for (std::size_t i = 0; i < 4; ++i) {
        const auto p = cube.node_position[static_cast<std::size_t>(nodes[i])];
        if (p.x + p.y + p.z == 0) a = i;
        if (p.x + p.y + p.z == 3) b = i;
      }
      const auto i = std::min(a, b), j = std::max(a, b);
      int edge = 0;
      while (mesh::tet::edge_to_corner[static_cast<std::size_t>(edge)][0] != static_cast<int>(i) ||
             mesh::tet::edge_to_corner[static_cast<std::size_t>(edge)][1] != static_cast<int>(j))
        ++edge;
      for (int child = 0; child < 2; ++child) {
        auto corners = nodes;
        for (auto& node : corners) node += first_node;
        corners[child == 0 ? j : i] = first_node + 8;
        whole.cell_to_node.push_back(corners);
        whole.lineage.push_back(mesh::Lineage(mesh::FamilyKind::edge, edge, child, 0));
      }
    }
  }
  whole.info.n_global_cells = static_cast<GlobalId>(whole.cell_to_node.size());
  whole.info.n_global_nodes = static_cast<GlobalId>(whole.node_position.size());
  return test::cut(comm, whole);
}

void expect_same(const mesh::BlockMesh& a, const mesh::BlockMesh& b) {
  EXPECT_EQ(a.info.n_global_cells, b.info.n_global_cells);
  EXPECT_TRUE(a.cell_to_node == b.cell_to_node);
  EXPECT_TRUE(a.cell_to_cell == b.cell_to_cell);
  EXPECT_TRUE(a.lineage == b.lineage);
  EXPECT_TRUE(a.node_position == b.node_position);
  ASSERT_EQ(a.cell_fields.size(), b.cell_fields.size());
  for (std::size_t i = 0; i < a.cell_fields.size(); ++i) EXPECT_TRUE(a.cell_fields[i].value == b.cell_fields[i].value);
  ASSERT_EQ(a.node_fields.size(), b.node_fields.size());
  for (std::size_t i = 0; i < a.node_fields.size(); ++i) EXPECT_TRUE(a.node_fields[i].value == b.node_fields[i].value);
}

TEST(OrderAlongCurve, GivesTheSameNumbersOnAnyNumberOfRanks) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const auto block = with_fields(
        comm, test::permute(comm, seed == 3 ? row_of_families(comm, 5) : test::random_mesh(comm, seed, 4), seed));
    const auto whole = test::gather(comm, block);

    const auto here = order_along_curve(comm, block);
    const auto serial = order_along_curve(self, whole);

    expect_same(test::gather(comm, here.block), serial.block);
    const auto part = [&](const std::vector<GlobalId>& all, GlobalId begin, std::size_t n) {
      return std::vector<GlobalId>(all.begin() + begin, all.begin() + begin + static_cast<GlobalId>(n));
    };
    EXPECT_EQ(here.cell_origin, part(serial.cell_origin, here.block.first_cell, here.block.cell_to_node.size()));
    const auto nodes = par::block_range(block.info.n_global_nodes, comm.rank(), comm.size());
    EXPECT_EQ(here.node_origin, part(serial.node_origin, nodes.begin, static_cast<std::size_t>(nodes.count())));
  }
}

TEST(OrderAlongCurve, DoesNotDependOnHowCellsLieInBlocks) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto whole = test::gather(comm, with_fields(comm, test::permute(comm, row_of_families(comm, 4), 9)));
  const auto expected = test::gather(comm, order_along_curve(comm, test::cut(comm, whole)).block);
  std::vector<GlobalId> all_on_last(static_cast<std::size_t>(comm.size()), 0), inside_families;
  for (Rank r = 0; r < comm.size(); ++r) inside_families.push_back(r == 0 ? 0 : 2 * r + 1);

  expect_same(test::gather(comm, order_along_curve(comm, test::cut(comm, whole, all_on_last)).block), expected);
  expect_same(test::gather(comm, order_along_curve(comm, test::cut(comm, whole, inside_families)).block), expected);
}

TEST(OrderAlongCurve, KeepsTheMesh) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const std::uint64_t seed : {1U, 2U, 3U, 4U}) {
    const auto block =
        seed % 2 == 0 ? test::random_mesh(comm, seed, 4) : test::permute(comm, row_of_families(comm, 5), seed);
    const auto before = assemble::assemble(comm, block);

    const auto after = assemble::assemble(comm, order_along_curve(comm, block).block);

    EXPECT_EQ(mesh::fingerprint(comm, after), mesh::fingerprint(comm, before));
    EXPECT_TRUE(validate::validate(comm, after).empty());
    EXPECT_EQ(after.info.patches, before.info.patches);
  }
}

TEST(OrderAlongCurve, TellsWhereCellsAndNodesComeFromAndCarriesFields) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = with_fields(comm, test::random_mesh(comm, 5, 4));
  const auto whole = test::gather(comm, block);

  const auto ordered = order_along_curve(comm, block);

  ASSERT_EQ(ordered.cell_origin.size(), ordered.block.cell_to_node.size());
  EXPECT_EQ(ordered.block.cell_fields[0].integer(), ordered.cell_origin);
  EXPECT_EQ(ordered.block.node_fields[0].integer(), ordered.node_origin);
  for (std::size_t c = 0; c < ordered.cell_origin.size(); ++c)
    EXPECT_EQ(ordered.block.cell_fields[1].real()[2 * c], 2.0 * static_cast<double>(ordered.cell_origin[c]));
  for (std::size_t i = 0; i < ordered.node_origin.size(); ++i)
    EXPECT_EQ(ordered.block.node_position[i], whole.node_position[static_cast<std::size_t>(ordered.node_origin[i])]);
}

TEST(OrderAlongCurve, PutsNeighborsCloseTogetherAndNodesInOrderOfFirstUse) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto whole =
      test::gather(comm, order_along_curve(comm, test::permute(comm, test::kuhn_cube(comm, 8), 1)).block);

  std::int64_t far = 0, links = 0;
  for (std::size_t c = 0; c < whole.cell_to_cell.size(); ++c)
    for (const auto other : whole.cell_to_cell[c]) {
      links += other < 0 ? 0 : 1;
      far += other < 0 || std::abs(other - static_cast<GlobalId>(c)) < 100 ? 0 : 1;
    }
  EXPECT_LT(4 * far, links);
  GlobalId next = 0;
  for (const auto& nodes : whole.cell_to_node)
    for (const auto node : nodes) {
      ASSERT_LE(node, next);
      next = std::max(next, node + 1);
    }
  EXPECT_EQ(next, whole.info.n_global_nodes);
}

TEST(OrderAlongCurve, IsTheSameWhenDoneTwice) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto once = order_along_curve(comm, test::random_mesh(comm, 6, 4)).block;

  const auto twice = order_along_curve(comm, once);

  expect_same(twice.block, once);
}

TEST(OrderAlongCurve, OrdersAMeshWithoutNeighborsOrLineage) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = test::without_neighbors(test::random_mesh(comm, 7, 4));
  const auto expected = mesh::fingerprint(comm, assemble::assemble(comm, block));

  const auto ordered = order_along_curve(comm, block);

  EXPECT_TRUE(ordered.block.cell_to_cell.empty());
  EXPECT_TRUE(ordered.block.lineage.empty());
  EXPECT_EQ(mesh::fingerprint(comm, assemble::assemble(comm, ordered.block)), expected);
}

TEST(OrderAlongCurve, NumbersFromTheFirstNumberOn) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = test::random_mesh(comm, 8, 3);
  const auto expected = order_along_curve(comm, block);

  const auto far = order_along_curve(comm, test::numbered_from(GlobalId{1} << 33U, block));

  expect_same(far.block, test::numbered_from(GlobalId{1} << 33U, expected.block));
  for (std::size_t c = 0; c < far.cell_origin.size(); ++c)
    ASSERT_EQ(far.cell_origin[c], expected.cell_origin[c] + (GlobalId{1} << 33U));
}

TEST(OrderAlongCurve, PutsNodesWithoutCellsLastInTheirOrder) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block =
      test::small_mesh(comm, {{9, 9, 9}, {0, 0, 1}, {8, 8, 8}, {1, 0, 0}, {0, 1, 0}, {0, 0, 0}}, {{5, 3, 4, 1}});

  const auto ordered = order_along_curve(comm, block);

  EXPECT_EQ(test::gather(comm, ordered.block).node_position,
            (std::vector<geometry::Vec3>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {9, 9, 9}, {8, 8, 8}}));
}

TEST(OrderAlongCurve, KeepsTheOrderOfCellsInOnePlace) {
  const par::Comm comm(MPI_COMM_WORLD);
  constexpr GlobalId first = (GlobalId{1} << 33U) + 253;  // the low eight bits of the numbers overflow on the way
  for (const int n : {1, 3}) {  // with n = 1 there are six cells, which may be fewer than ranks
    auto whole = test::gather(comm, test::without_neighbors(test::kuhn_cube(comm, n)));
    for (auto& point : whole.node_position) point = {1, 2, 3};
    const std::vector<GlobalId> all_on_last(static_cast<std::size_t>(comm.size()), 0);
    for (const auto& block : {test::cut(comm, whole), test::cut(comm, whole, all_on_last)}) {
      const auto ordered = order_along_curve(comm, test::numbered_from(first, block));

      const auto cells = par::block_range(ordered.block.info.cell_ids(), comm.rank(), comm.size());
      ASSERT_EQ(static_cast<GlobalId>(ordered.cell_origin.size()), cells.count());
      for (std::size_t c = 0; c < ordered.cell_origin.size(); ++c)
        EXPECT_EQ(ordered.cell_origin[c], cells.begin + static_cast<GlobalId>(c));
    }
  }
}

TEST(OrderAlongCurve, CarriesOriginsThatAreGiven) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto block = test::random_mesh(comm, 11, 4);
  for (std::size_t c = 0; c < block.cell_to_node.size(); ++c)
    block.cell_origin.push_back(1000 + block.first_cell + static_cast<GlobalId>(c));

  const auto ordered = order_along_curve(comm, std::move(block));

  ASSERT_EQ(ordered.block.cell_origin.size(), ordered.cell_origin.size());
  for (std::size_t c = 0; c < ordered.cell_origin.size(); ++c)
    EXPECT_EQ(ordered.block.cell_origin[c], 1000 + ordered.cell_origin[c]);
}

TEST(Route, SendsRowsInAnyNumberOfRounds) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = test::random_mesh(comm, 12, 4);
  const auto key_of_cell = [](GlobalId cell) { return combine(7, static_cast<std::uint64_t>(cell)) % 11 << 59U; };
  std::vector<GlobalId> expected(static_cast<std::size_t>(block.info.n_global_cells)), cell;
  std::iota(expected.begin(), expected.end(), 0);
  std::stable_sort(expected.begin(), expected.end(),
                   [&](GlobalId a, GlobalId b) { return key_of_cell(a) < key_of_cell(b); });
  std::vector<std::uint64_t> key;
  for (std::size_t c = 0; c < block.cell_to_node.size(); ++c) {
    cell.push_back(block.first_cell + static_cast<GlobalId>(c));
    key.push_back(key_of_cell(cell.back()));
  }

  auto route = find_route(comm, block, key);

  const auto here = par::block_range(block.info.cell_ids(), comm.rank(), comm.size());
  for (const int rounds : {1, 3, 1000}) {  // in the last, parts have fewer rows than there are rounds
    route.rounds = rounds;
    auto one = cell;
    std::vector<double> two;
    for (const auto number : cell) two.insert(two.end(), {0.5 * static_cast<double>(number), 3.0});
    send_rows(comm, route, one, 1);
    send_rows(comm, route, two, 2);
    ASSERT_EQ(static_cast<GlobalId>(one.size()), here.count());
    ASSERT_EQ(two.size(), 2 * one.size());
    for (std::size_t i = 0; i < one.size(); ++i) {
      ASSERT_EQ(one[i], expected[static_cast<std::size_t>(here.begin) + i]);
      ASSERT_EQ(two[2 * i], 0.5 * static_cast<double>(one[i]));
      ASSERT_EQ(two[2 * i + 1], 3.0);
    }
  }
}

TEST(OrderAlongCurve, TakesAMeshWithoutCells) {
  const par::Comm comm(MPI_COMM_WORLD);

  const auto ordered = order_along_curve(comm, test::small_mesh(comm, {}, {}));

  EXPECT_TRUE(ordered.block.cell_to_node.empty());
  EXPECT_TRUE(ordered.cell_origin.empty());
}

TEST(OrderAlongCurve, LeavesCoordinatesThatAreNotFiniteToValidation) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto block = test::random_mesh(comm, 9, 3);
  if (comm.is_first()) {
    block.node_position[0].x = std::numeric_limits<double>::quiet_NaN();
    block.node_position[1].y = std::numeric_limits<double>::infinity();
  }

  const auto violations = validate::validate(comm, assemble::assemble(comm, order_along_curve(comm, block).block));

  ASSERT_FALSE(violations.empty());
  EXPECT_EQ(violations[0].invariant, "finite_coordinates");
  EXPECT_GE(violations[0].count, 2);  // on each rank that holds the node
}

TEST(OrderAlongCurve, RefusesNumbersOutOfRangeByTheNumbersOfTheInput) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto message_of = [&](mesh::BlockMesh whole) -> std::string {
    try {
      order_along_curve(comm, test::cut(comm, whole));
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  const auto whole = test::gather(comm, test::random_mesh(comm, 10, 2));
  auto bad_node = whole, bad_neighbor = whole, bad_lineage = whole;
  bad_node.cell_to_node[17][2] = whole.info.n_global_nodes;
  bad_neighbor.cell_to_cell[23][1] = whole.info.n_global_cells;
  bad_lineage.lineage.assign(whole.cell_to_node.size(), mesh::Lineage());
  bad_lineage.lineage[31] = mesh::Lineage(mesh::FamilyKind::edge, 0, 1, 0);

  EXPECT_NE(message_of(bad_node).find("cell_to_node, cell 17:"), std::string::npos) << message_of(bad_node);
  EXPECT_NE(message_of(bad_neighbor).find("cell_to_cell, cell 23:"), std::string::npos) << message_of(bad_neighbor);
  EXPECT_NE(message_of(bad_lineage).find("cell 30"), std::string::npos) << message_of(bad_lineage);
}

/// 48,000 cells: too many for any order to do.
mesh::BlockMesh large_cube(const par::Comm& comm) { return test::kuhn_cube(comm, 20); }

TEST(IsOrdered, HoldsForTheOrdersThatToolsWrite) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto lexicographic = large_cube(comm);

  EXPECT_TRUE(is_ordered(comm, lexicographic));
  EXPECT_TRUE(is_ordered(comm, test::without_neighbors(lexicographic)));
  const auto curve = order_along_curve(comm, test::permute(comm, lexicographic, 1)).block;
  EXPECT_TRUE(is_ordered(comm, curve));
  EXPECT_TRUE(is_ordered(comm, test::without_neighbors(curve)));
}

TEST(IsOrdered, FailsForShuffledCellsOfALargeMesh) {
  const par::Comm comm(MPI_COMM_WORLD);
  // 82,944 cells: the mean distance of two random numbers is a third of that
  const auto shuffled = test::permute(comm, test::kuhn_cube(comm, 24), 2);

  EXPECT_FALSE(is_ordered(comm, shuffled));
  EXPECT_FALSE(is_ordered(comm, test::without_neighbors(shuffled)));
}

TEST(IsOrdered, HoldsForSmallMeshesInAnyOrder) {
  const par::Comm comm(MPI_COMM_WORLD);

  EXPECT_TRUE(is_ordered(comm, test::permute(comm, test::kuhn_cube(comm, 8), 3)));
}

TEST(MeasureDisorder, CountsTheSameOnAnyNumberOfRanks) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  for (const bool has_neighbors : {true, false}) {
    auto block = test::permute(comm, large_cube(comm), 4);
    if (!has_neighbors) block = test::without_neighbors(std::move(block));

    const auto here = measure_disorder(comm, block), serial = measure_disorder(self, test::gather(comm, block));

    EXPECT_EQ(here.links, serial.links);
    EXPECT_EQ(here.far_links, serial.far_links);
    EXPECT_EQ(here.corners, serial.corners);
    EXPECT_EQ(here.lonely_corners, serial.lonely_corners);
    EXPECT_GT(here.far_links, 0);
  }
}

}  // namespace order_test
}  // namespace pamr::order
