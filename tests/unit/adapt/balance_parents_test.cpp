// SPDX-License-Identifier: GPL-3.0-or-later
// Balancing between closing and splitting: the refined mesh is the same one, and better spread.
#include "pamr/adapt/balance_parents.hpp"

#include <gtest/gtest.h>

#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/forecast.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/validate/validate.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace balance_parents_test {

using refine::QualityControl;

std::vector<std::uint8_t> random_flags(const mesh::DistMesh& mesh, std::uint64_t seed) {
  std::vector<std::uint8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    // more in one corner, so that there is something to balance
    const auto p = mesh.points(c)[0];
    const std::uint64_t one_in = p.x + p.y + p.z < 1 ? 3 : 40;
    const auto id = static_cast<std::uint64_t>(mesh.cell_global[static_cast<std::size_t>(c)]);
    flags.push_back(combine(seed, id) % one_in == 0 ? 1 : 0);
  }
  return flags;
}

void expect_equal(const mesh::BlockMesh& a, const mesh::BlockMesh& b) {
  EXPECT_TRUE(a.node_position == b.node_position);
  EXPECT_TRUE(a.cell_to_node == b.cell_to_node);
  EXPECT_TRUE(a.cell_to_cell == b.cell_to_cell);
  EXPECT_TRUE(a.lineage == b.lineage);
  ASSERT_EQ(a.cell_fields.size(), b.cell_fields.size());
  for (std::size_t i = 0; i < a.cell_fields.size(); ++i) EXPECT_TRUE(a.cell_fields[i].value == b.cell_fields[i].value);
}

class EveryPolicy : public ::testing::TestWithParam<QualityControl> {};
INSTANTIATE_TEST_SUITE_P(BalanceParents, EveryPolicy,
                         ::testing::Values(QualityControl::none, QualityControl::isotropic, QualityControl::short_edge,
                                           QualityControl::removable));

TEST_P(EveryPolicy, GivesTheSerialMeshWhateverTheBalancing) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  constexpr std::uint64_t n_levels = 2;
  for (const std::uint64_t seed : {1U, 2U}) {
    const auto block = test::random_mesh(comm, seed, 3);
    const auto whole = test::gather(comm, block);
    auto serial = assemble::assemble(self, test::cut(self, whole));
    for (std::uint64_t level = 0; level < n_levels; ++level)
      serial = adapt::refine(self, serial, random_flags(serial, seed + level),
                             {.quality_control = GetParam(), .marks_field = ""})
                   .mesh;
    const auto expected = test::gather(self, serial);

    for (const auto& [method, weights] :
         {std::pair{"scotch", "exact"}, {"scotch", "8/1"}, {"curve", "exact"}, {"blocks", "exact"}}) {
      auto mesh = assemble::assemble(comm, block, test::random_destinations(comm, block, seed));
      for (std::uint64_t level = 0; level < n_levels; ++level) {
        auto balancing = adapt::balancing_named(method, weights);
        balancing.how.keep_below = 0;
        balancing.how.vertices_per_part = 40;
        const auto flags = random_flags(mesh, seed + level);
        mesh = adapt::refine(comm, std::move(mesh), flags, {.quality_control = GetParam()}, balancing).mesh;
      }
      SCOPED_TRACE(std::string(method) + " " + weights);
      expect_equal(test::gather(comm, mesh), expected);
      EXPECT_TRUE(validate::validate(comm, mesh).empty());
    }
  }
}

TEST_P(EveryPolicy, PredictsEachCellsChildrenExactly) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, test::random_mesh(comm, 3, 3));
  for (std::uint64_t level = 0; level < 3; ++level) {
    const auto flags = random_flags(mesh, level);
    const refine::Options options{.quality_control = GetParam(), .marks_field = ""};
    const auto children = adapt::Forecaster(comm, mesh, options).forecast(flags).children;
    auto result = adapt::refine(comm, mesh, flags, options);

    std::int64_t here = 0;
    for (const auto n : children) here += n;
    EXPECT_EQ(here, result.mesh.n_cells());
    mesh = std::move(result.mesh);
  }
}

TEST(BalanceParents, SpreadsTheRefinedMeshEvenly) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const auto* method : {"auto", "scotch", "curve", "blocks"}) {
    auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 10));
    const auto flags = random_flags(mesh, 1);

    const auto result = adapt::refine(comm, std::move(mesh), flags, {}, adapt::balancing_named(method, "exact"));

    const auto& balance = result.report.balance;
    const auto largest = comm.max(std::int64_t{result.mesh.n_cells()});
    EXPECT_DOUBLE_EQ(balance.after.imbalance, static_cast<double>(largest) * static_cast<double>(comm.size()) /
                                                  static_cast<double>(result.mesh.info.n_global_cells));
    EXPECT_LE(balance.after.imbalance, 1.05);
    EXPECT_EQ(balance.before.imbalance > balance.after.imbalance, comm.size() > 1);
  }
}

TEST(BalanceParents, WorksOnMoreRanksThanCells) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const auto* method : {"auto", "scotch", "curve", "blocks", "none"}) {
    auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 1));  // six cells
    for (std::int64_t expected = 48; expected <= 384; expected *= 8) {
      const std::vector<std::uint8_t> all(static_cast<std::size_t>(mesh.n_cells()), 1);
      auto result = adapt::refine(comm, std::move(mesh), all, {}, adapt::balancing_named(method, "exact"));
      mesh = std::move(result.mesh);
      EXPECT_EQ(mesh.info.n_global_cells, expected);
      EXPECT_TRUE(validate::validate(comm, mesh).empty());
    }
  }
}

TEST(BalanceParents, WeighsByACellField) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 8));
  std::vector<double> cost;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) cost.push_back(mesh.points(c)[0].y < 0.2 ? 9.5 : 0.5);
  mesh.cell_fields.push_back({"cost", "", 1, mesh::StorageType::float64, std::move(cost)});
  const std::vector<std::uint8_t> nothing(static_cast<std::size_t>(mesh.n_cells()), 0);

  const auto result = adapt::refine(comm, std::move(mesh), nothing, {}, adapt::balancing_named("scotch", "cost"));

  double here = 0, total = 0;
  for (const auto c : result.mesh.find_cell_field("cost")->real()) here += c;
  for (const auto sum : comm.all_gather(here)) total += sum;
  EXPECT_LE(comm.max(here) * comm.size(), 1.05 * total);
}

TEST(BalanceParents, RefusesBadWeightsOnEveryRank) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 2));
  const std::vector<std::uint8_t> nothing(static_cast<std::size_t>(mesh.n_cells()), 0);
  auto copy = mesh;

  EXPECT_THROW(adapt::refine(comm, std::move(copy), nothing, {}, adapt::balancing_named("scotch", "load")), Error);
  EXPECT_THROW(adapt::balancing_named("metis", "exact"), Error);
}

}  // namespace balance_parents_test
}  // namespace pamr
