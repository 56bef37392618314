// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/rebalance.hpp"

#include <gtest/gtest.h>

#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/balance/scotch_partition.hpp"
#include "pamr/base/error.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/validate/validate.hpp"
#include "refined_mesh.hpp"

namespace pamr {
namespace rebalance_test {

using balance::Method;

std::vector<double> particles(const mesh::DistMesh& mesh) {
  std::vector<double> number;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) number.push_back(mesh.points(c)[0].z < 0.4 ? 20.0 : 0.0);
  return number;
}

TEST(Rebalance, EvensOutTheParticlesOfASolver) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = test::refined_mesh(comm, 1);
  const auto fingerprint = mesh::fingerprint(comm, mesh);
  const auto n_cells = mesh.info.n_global_cells;

  const auto weight = particles(mesh);
  const auto result = balance::rebalance(comm, std::move(mesh), weight);

  EXPECT_LE(result.report.after.imbalance, 1.06);  // families of up to seven cells stay together
  double here = 0;
  for (const auto n : particles(result.mesh)) here += n;
  const auto all = comm.all_gather(here);
  double total = 0;
  for (const auto n : all) total += n;
  EXPECT_LE(comm.max(here) * comm.size() / total, 1.06);
  EXPECT_TRUE(validate::validate(comm, result.mesh).empty());
  EXPECT_EQ(mesh::fingerprint(comm, result.mesh), fingerprint);
  EXPECT_EQ(comm.sum(result.mesh.n_cells()), n_cells);
  // the fields came along
  const auto& velocity = result.mesh.find_cell_field("velocity")->real();
  for (std::size_t c = 0; c < result.mesh.cell_global.size(); ++c)
    ASSERT_EQ(velocity[3 * c + 2], -static_cast<double>(result.mesh.cell_global[c]));
}

/// A cube whose numbers say nothing of where its cells lie.
mesh::DistMesh without_order(const par::Comm& comm, int n) {
  return assemble::assemble(comm, test::permute(comm, assemble::kuhn_cube(comm, n), 7));
}

TEST(Rebalance, AsksForFewFacesBetweenRanksAsMuchAsForEvenRanks) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const balance::Options& how : {balance::Options{.method = Method::scotch},
                                      balance::Options{.method = Method::best, .keep_below = 1.05, .passes = 1e6},
                                      balance::Options{.method = Method::best, .keep_below = 1.05}}) {
    auto mesh = without_order(comm, 10);
    const std::vector<double> ones(mesh.cell_global.size(), 1);

    const auto result = balance::rebalance(comm, std::move(mesh), ones, how);

    const auto& [given, before, after, moved, _, __] = result.report;
    EXPECT_LE(before.imbalance, 1.02);
    EXPECT_EQ(static_cast<double>(before.edge_cut) > 1.5 * before.compact_cut, comm.size() > 1);
    EXPECT_EQ(given != Method::none, comm.size() > 1);
    EXPECT_EQ(moved > 0, comm.size() > 1);
    EXPECT_LE(after.imbalance, 1.05);
    // for one pass Scotch would cost more than its fewer faces are worth
    const bool is_curve = !balance::has_scotch() || (how.method == Method::best && how.passes < 2);
    const double most = is_curve ? 2.5 : 1.5;
    EXPECT_LE(static_cast<double>(after.edge_cut), most * after.compact_cut);
    const std::vector<std::int64_t> again(result.mesh.cell_global.size(), 1);
    EXPECT_EQ(balance::partition(comm, result.mesh, again, comm.size(), how).method, Method::none);
  }
}

TEST(Rebalance, AsksTheSameForWeightsOfASolver) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const auto method : {Method::best, Method::scotch}) {
    auto mesh = without_order(comm, 10);
    std::vector<double> seconds;
    for (LocalId c = 0; c < mesh.n_cells(); ++c) seconds.push_back(mesh.points(c)[0].z < 0.4 ? 3e-6 : 1e-6);

    const balance::Options how{.method = method, .keep_below = 1.05, .passes = 1e6};
    const auto result = balance::rebalance(comm, std::move(mesh), seconds, how);

    EXPECT_LE(result.report.after.imbalance, 1.05);
    EXPECT_LE(static_cast<double>(result.report.after.edge_cut),
              (balance::has_scotch() ? 1.5 : 2.5) * result.report.after.compact_cut);
    EXPECT_EQ(result.report.moved_cells > 0, comm.size() > 1);
  }
}

TEST(Rebalance, MovesNothingForNothingWhereTheBarsCannotBeReached) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const auto method : {Method::best, Method::scotch, Method::curve, Method::blocks})
    for (const int n : {1, 4}) {
      auto mesh = without_order(comm, n);
      // one cell that outweighs all others, so that its rank has too much and one of the others nothing to give
      const auto weigh = [](const mesh::DistMesh& m) {
        std::vector<std::int64_t> weight;
        for (const auto id : m.cell_global) weight.push_back(id == 3 ? 1000 : 1);
        return weight;
      };
      for (int call = 0; call < 4; ++call) {
        const auto weight = weigh(mesh);
        auto result = balance::rebalance(comm, std::move(mesh), weight, {.method = method});
        if (call == 3) {
          EXPECT_EQ(result.report.moved_cells, 0) << balance::name_of(method) << " " << n;
        }
        mesh = std::move(result.mesh);
      }
    }
}

TEST(Rebalance, CountsTheCellsThatMoved) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = test::refined_mesh(comm, 2);
  const auto before = mesh.cell_global;

  const auto weight = particles(mesh);
  const auto result = balance::rebalance(comm, std::move(mesh), weight, {.keep_below = 0});

  std::int64_t stayed = 0;
  for (const auto id : result.mesh.cell_global) stayed += std::binary_search(before.begin(), before.end(), id) ? 1 : 0;
  EXPECT_EQ(result.report.moved_cells, result.mesh.info.n_global_cells - comm.sum(stayed));
}

TEST(Rebalance, RefusesBadWeightsOnEveryRank) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = test::refined_mesh(comm, 2);
  auto weight = particles(mesh);
  if (comm.rank() == comm.size() - 1) weight.back() = -1;

  EXPECT_THROW(balance::rebalance(comm, mesh, weight), Error);
  EXPECT_THROW(balance::rebalance(comm, mesh, std::vector<double>(weight.size(), 0.0)), Error);
}

}  // namespace rebalance_test
}  // namespace pamr
