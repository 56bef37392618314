// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/rebalance.hpp"

#include <gtest/gtest.h>

#include "pamr/base/error.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/validate/validate.hpp"
#include "refined_mesh.hpp"

namespace pamr {
namespace rebalance_test {

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
