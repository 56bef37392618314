// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/partition.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <set>

#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/balance/migrate.hpp"
#include "pamr/balance/parts_along_curve.hpp"
#include "pamr/balance/price.hpp"
#include "pamr/balance/scotch_partition.hpp"
#include "pamr/balance/weighted_blocks.hpp"
#include "pamr/balance/weights.hpp"
#include "pamr/order/order_along_curve.hpp"
#include "refined_mesh.hpp"

namespace pamr {
namespace partition_test {

using balance::Method;

std::vector<std::int64_t> uneven_weights(const mesh::DistMesh& mesh) {
  std::vector<std::int64_t> weight;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) weight.push_back(mesh.points(c)[0].x < 0.3 ? 8 : 1);
  return weight;
}

void expect_sound(const mesh::DistMesh& mesh, const std::vector<Rank>& part, Rank n_parts) {
  ASSERT_EQ(part.size(), mesh.cell_global.size());
  for (std::size_t c = 0; c < part.size(); ++c) {
    EXPECT_GE(part[c], 0);
    EXPECT_LT(part[c], n_parts);
    const auto child = mesh.lineage[c].is_removable() ? mesh.lineage[c].child() : 0;
    EXPECT_EQ(part[c], part[c - static_cast<std::size_t>(child)]) << "a family is torn";
  }
}

TEST(Partition, BalancesUnevenWeightsForAnyNumberOfParts) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = test::refined_mesh(comm, 1);
  const auto weight = uneven_weights(mesh);
  for (const auto method : {Method::scotch, Method::curve, Method::blocks})
    for (const Rank n_parts : {1, 2, 3, 5, 16}) {
      const auto result = balance::partition(comm, mesh, weight, n_parts, {.method = method, .keep_below = 0});

      expect_sound(mesh, result.part, n_parts);
      // a family weighs up to 32 of some 3000
      EXPECT_LE(result.quality.imbalance, n_parts == 16 ? 1.15 : 1.05) << n_parts << " parts";
      EXPECT_EQ(result.quality.empty_parts, 0);
      EXPECT_EQ(result.quality.edge_cut > 0, n_parts > 1);
    }
}

TEST(Partition, TakesRunsWhereTheseCutFewFacesAndTheCurveOrScotchWhereTheyDoNot) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto ordered = order::order_along_curve(comm, assemble::kuhn_cube(comm, 8)).block;
  const auto in_order = assemble::assemble(comm, ordered);
  const auto in_no_order = assemble::assemble(comm, test::permute(comm, ordered, 5));
  const balance::Options how{.method = Method::best, .keep_below = 0};
  const std::vector<std::int64_t> ones(in_order.cell_global.size(), 1);

  const auto runs = balance::partition(comm, in_order, ones, 4, how);
  const auto parts = balance::partition(comm, in_no_order, ones, 4, how);

  EXPECT_EQ(runs.method, Method::blocks);
  EXPECT_EQ(parts.method, Method::curve);
  expect_sound(in_order, runs.part, 4);
  expect_sound(in_no_order, parts.part, 4);
  EXPECT_TRUE(meets(runs.quality, {.keep_below = 1.05}));
  EXPECT_TRUE(meets(parts.quality, {.keep_below = 1.05}));
}

TEST(Partition, TakesScotchWhereItsFewerFacesServeManyPasses) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::permute(comm, assemble::kuhn_cube(comm, 10), 5));
  const std::vector<std::int64_t> ones(mesh.cell_global.size(), 1);

  balance::Options how{.method = Method::best, .keep_below = 0, .max_cut = 2, .passes = 1};
  const auto few = balance::partition(comm, mesh, ones, 5, how);
  how.passes = 1e6;
  const auto many = balance::partition(comm, mesh, ones, 5, how);

  EXPECT_EQ(few.method, Method::curve);
  EXPECT_EQ(many.method, balance::has_scotch() ? Method::scotch : Method::curve);
  if (balance::has_scotch()) {
    EXPECT_LT(many.quality.edge_cut, few.quality.edge_cut);
  }
}

TEST(Partition, CutsRunsWhereNoneIsAskedForOtherPartsThanRanks) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto scattered = test::refined_mesh(comm, 3);
  const auto n_parts = static_cast<Rank>(comm.size() + 3);

  const auto result = balance::partition(comm, scattered, uneven_weights(scattered), n_parts, {.method = Method::none});

  EXPECT_EQ(result.method, Method::blocks);
  expect_sound(scattered, result.part, n_parts);
}

TEST(Partition, CutsFewerFacesThanRunsOfCellsInRandomOrder) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = test::refined_mesh(comm, 3);  // its cells are in random order
  const auto weight = uneven_weights(mesh);

  const auto scotch = balance::partition(comm, mesh, weight, 4, {.method = Method::scotch, .keep_below = 0});
  const auto blocks = balance::partition(comm, mesh, weight, 4, {.method = Method::blocks, .keep_below = 0});

  EXPECT_EQ(scotch.method, balance::has_scotch() ? Method::scotch : Method::curve);
  EXPECT_LT(3 * scotch.quality.edge_cut, blocks.quality.edge_cut);
}

TEST(Partition, CutsAsFewFacesForRealWeightsAsForThoseRounded) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = test::refined_mesh(comm, 3);
  std::vector<double> real, rounded, with_none;
  for (const auto id : mesh.cell_global) {
    real.push_back(0.5 + 0.5 * static_cast<double>(id * 7919 % 1009) / 1009);
    rounded.push_back(std::round(1000 * real.back()));
    with_none.push_back(id == 0 ? 0 : rounded.back());
  }
  const auto cut = [&](const std::vector<double>& weight) {
    const auto integers = balance::integer_weights(comm, mesh, weight);
    const auto result = balance::partition(comm, mesh, integers, 4, {.method = Method::scotch, .keep_below = 0});
    EXPECT_EQ(result.method, balance::has_scotch() ? Method::scotch : Method::curve);
    return static_cast<double>(result.quality.edge_cut);
  };

  const double expected = cut(rounded);
  EXPECT_LT(cut(real), 1.15 * expected);
  EXPECT_LT(cut(with_none), 1.15 * expected);
}

TEST(Partition, IsTheSameWhenItIsMadeAgain) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 8));
  const auto weight = uneven_weights(mesh);

  const auto first = balance::partition(comm, mesh, weight, 4, {.keep_below = 0});
  for (int again = 0; again < 3; ++again)
    EXPECT_EQ(balance::partition(comm, mesh, weight, 4, {.keep_below = 0}).part, first.part);
}

TEST(Partition, KeepsWhatIsBalancedAlready) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 4));
  const std::vector<std::int64_t> weight(mesh.cell_global.size(), 1);

  // slabs, of which seven cut more faces than compact parts
  const auto result =
      balance::partition(comm, mesh, weight, comm.size(), {.method = Method::blocks, .keep_below = 1.02});

  EXPECT_EQ(result.method, Method::none);
  EXPECT_EQ(result.part, std::vector<Rank>(mesh.cell_global.size(), comm.rank()));
}

TEST(Partition, MovesFewCellsWhenLittleIsOutOfBalance) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 8));
  const std::vector<std::int64_t> ones(mesh.cell_global.size(), 1);
  const auto before = balance::partition(comm, mesh, ones, comm.size(), {.keep_below = 0});
  mesh = balance::migrate(comm, std::move(mesh), before.part);

  const std::vector<std::int64_t> again(mesh.cell_global.size(), 1);
  const auto result = balance::partition(comm, mesh, again, comm.size(), {.keep_below = 0});

  std::int64_t stay = 0;
  for (const auto part : result.part) stay += part == comm.rank() ? 1 : 0;
  // parts are named after the rank that holds most of them: at least a fair share stays
  EXPECT_GE(comm.sum(stay) * comm.size(), mesh.info.n_global_cells);
}

TEST(Partition, LeavesPartsEmptyWhenThereAreMorePartsThanCells) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 1));  // six cells
  const std::vector<std::int64_t> weight(mesh.cell_global.size(), 1);
  for (const auto method : {Method::scotch, Method::curve, Method::blocks})
    for (const Rank n_parts : {comm.size(), 6, 20}) {
      const auto result = balance::partition(comm, mesh, weight, n_parts, {.method = method, .keep_below = 0});

      expect_sound(mesh, result.part, n_parts);
      EXPECT_EQ(result.quality.empty_parts, std::max(0, n_parts - 6));
      const double largest = n_parts < 6 ? (6 + n_parts - 1) / n_parts : 1;  // cells
      EXPECT_DOUBLE_EQ(result.quality.imbalance, largest * n_parts / 6);
    }
}

TEST(Partition, WorksWhereAllCellsLieOnOneRank) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const auto method : {Method::scotch, Method::blocks}) {
    auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 6));
    const std::vector<Rank> to_the_last(mesh.cell_global.size(), comm.size() - 1);
    mesh = balance::migrate(comm, std::move(mesh), to_the_last);
    const std::vector<std::int64_t> weight(mesh.cell_global.size(), 1);

    const auto result = balance::partition(comm, mesh, weight, comm.size(), {.method = method});

    expect_sound(mesh, result.part, comm.size());
    EXPECT_LE(result.quality.imbalance, 1.05);
    EXPECT_EQ(result.quality.empty_parts, 0);
  }
}

TEST(Partition, MeasuresWhatASlowCountMeasures) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto mesh = test::refined_mesh(comm, 4);
  constexpr Rank n_parts = 5;
  const auto part = test::random_ranks(mesh, 9, n_parts);
  const auto whole = test::gather(comm, mesh);
  const auto alone = assemble::assemble(self, test::cut(self, whole));
  const auto part_alone = test::random_ranks(alone, 9, n_parts);

  const auto quality = balance::measure(comm, mesh, uneven_weights(mesh), part, n_parts);

  std::vector<std::int64_t> sum(n_parts, 0);
  std::vector<std::set<Rank>> neighbors(n_parts);
  std::int64_t cut = 0, total = 0;
  const auto weight = uneven_weights(alone);
  for (std::size_t c = 0; c < part_alone.size(); ++c) {
    sum[static_cast<std::size_t>(part_alone[c])] += weight[c];
    total += weight[c];
    for (const auto neighbor : alone.cell_to_cell[c]) {
      if (neighbor < 0 || part_alone[static_cast<std::size_t>(neighbor)] == part_alone[c]) continue;
      ++cut;
      neighbors[static_cast<std::size_t>(part_alone[c])].insert(part_alone[static_cast<std::size_t>(neighbor)]);
    }
  }
  EXPECT_EQ(quality.edge_cut, cut / 2);
  EXPECT_DOUBLE_EQ(quality.imbalance, static_cast<double>(*std::max_element(sum.begin(), sum.end())) * n_parts /
                                          static_cast<double>(total));
  std::size_t most = 0;
  for (const auto& set : neighbors) most = std::max(most, set.size());
  EXPECT_EQ(quality.max_neighbors, static_cast<std::int64_t>(most));
}

TEST(Partition, MeasuresTheRanksFromTheirBordersAsFromTheCells) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = test::refined_mesh(comm, 4);
  const auto weight = uneven_weights(mesh);
  const std::vector<Rank> own(weight.size(), comm.rank());
  std::int64_t here = 0;
  for (const auto w : weight) here += w;

  const auto expected = balance::measure(comm, mesh, weight, own, comm.size());
  const auto quality = balance::measure_ranks(comm, mesh, here);

  EXPECT_EQ(quality.imbalance, expected.imbalance);
  EXPECT_EQ(quality.edge_cut, expected.edge_cut);
  EXPECT_EQ(quality.max_neighbors, expected.max_neighbors);
  EXPECT_EQ(quality.mean_neighbors, expected.mean_neighbors);
  EXPECT_EQ(quality.empty_parts, expected.empty_parts);
}

TEST(PartsAlongCurve, GivesEachCellThePartItHasWhereverTheCellsAre) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = test::refined_mesh(comm, 6);
  const auto tell = [&](const mesh::DistMesh& m) {
    const auto part = balance::parts_along_curve(comm, m, uneven_weights(m), 3);
    expect_sound(m, part, 3);
    std::uint64_t sum = 0;
    for (std::size_t c = 0; c < part.size(); ++c)
      sum += combine(static_cast<std::uint64_t>(m.cell_global[c]), static_cast<std::uint64_t>(part[c])) >> 32U;
    return comm.sum(static_cast<std::int64_t>(sum));
  };
  const auto in_runs = tell(mesh);

  const auto scattered = test::random_ranks(mesh, 1, comm.size());
  mesh = balance::migrate(comm, std::move(mesh), scattered);

  EXPECT_EQ(tell(mesh), in_runs);
}

TEST(PartsAlongCurve, CutsTheCubeIntoItsEighths) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::permute(comm, assemble::kuhn_cube(comm, 8), 3));
  const std::vector<std::int64_t> ones(mesh.cell_global.size(), 1);

  const auto part = balance::parts_along_curve(comm, mesh, ones, 8);

  const auto quality = balance::measure(comm, mesh, ones, part, 8);
  EXPECT_EQ(quality.imbalance, 1);
  EXPECT_EQ(quality.edge_cut, 3 * 8 * 8 * 2);  // three planes through the middle
  EXPECT_NEAR(static_cast<double>(quality.edge_cut) / quality.compact_cut, 1, 0.01);
}

TEST(WeightedBlocks, GivesEachCellThePartItHasWhereverTheCellsAre) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = test::refined_mesh(comm, 6);
  const auto tell = [&](const mesh::DistMesh& m) {
    const auto part = balance::weighted_blocks(comm, m, uneven_weights(m), 3);
    expect_sound(m, part, 3);
    std::uint64_t sum = 0;
    for (std::size_t c = 0; c < part.size(); ++c)
      sum += combine(static_cast<std::uint64_t>(m.cell_global[c]), static_cast<std::uint64_t>(part[c])) >> 32U;
    return comm.sum(static_cast<std::int64_t>(sum));
  };
  const auto in_runs = tell(mesh);

  const auto scattered = test::random_ranks(mesh, 1, comm.size());
  mesh = balance::migrate(comm, std::move(mesh), scattered);

  EXPECT_EQ(tell(mesh), in_runs);
}

}  // namespace partition_test
}  // namespace pamr
