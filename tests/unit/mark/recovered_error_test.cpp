// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mark/recovered_error.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <numeric>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "support/meshes.hpp"

namespace pamr::mark {
namespace recovered_error_test {

using geometry::Vec3;

/// A random mesh scattered over the ranks with nodal field `psi`.
template <class Function>
mesh::DistMesh mesh_with(const par::Comm& comm, Function&& psi, int n = 4) {
  auto block = test::random_mesh(comm, 21, n);
  mesh::Field field;
  field.name = "psi";
  for (const auto p : block.node_position) field.real().push_back(psi(p));
  block.node_fields = {field};
  const auto destination = test::random_destinations(comm, block, 22);
  return assemble::assemble(comm, std::move(block), destination);
}

double front(Vec3 p) { return std::tanh(8 * (p.x - 0.4)) + 0.1 * p.y * p.z; }

TEST(RecoveredError, VanishesForALinearField) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = mesh_with(comm, [](Vec3 p) { return 3 + 2 * p.x - p.y + 0.5 * p.z; });

  const auto error = recovered_error(comm, mesh, "psi");

  EXPECT_NEAR(error.norm_squared, 4 + 1 + 0.25, 1e-12);
  EXPECT_LT(error.total_squared, 1e-24);
}

TEST(RecoveredError, HasTheSameBitsForEveryNumberOfRanks) {
  par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto shared = mesh_with(world, front), whole = mesh_with(self, front);

  const auto error = recovered_error(world, shared, "psi"), twin = recovered_error(self, whole, "psi");

  EXPECT_EQ(std::bit_cast<std::uint64_t>(error.total_squared), std::bit_cast<std::uint64_t>(twin.total_squared));
  EXPECT_EQ(std::bit_cast<std::uint64_t>(error.norm_squared), std::bit_cast<std::uint64_t>(twin.norm_squared));
  for (std::size_t i = 0; i < error.squared.size(); ++i)
    EXPECT_EQ(std::bit_cast<std::uint64_t>(error.squared[i]),
              std::bit_cast<std::uint64_t>(twin.squared[static_cast<std::size_t>(shared.cell_global[i])]));
}

TEST(RecoveredError, IsTheIntegralOfTheDifferenceInOneCell) {
  // Two cells on a common face with gradients (1,0,0) and (g,0,0): the three nodes of the face get the weighted mean,
  // the others keep their own, so e^2 = V/20 (3 d^2 + (3 d)^2) with the difference d at the three.
  par::Comm comm(MPI_COMM_WORLD);
  auto block =
      test::small_mesh(comm, {{0, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 0}, {-2, 0, 0}}, {{0, 3, 1, 2}, {0, 1, 4, 2}});
  mesh::Field field;
  field.name = "psi";
  for (const auto p : block.node_position) field.real().push_back(p.x > 0 ? p.x : 4 * p.x);
  block.node_fields = {field};
  const auto mesh = assemble::assemble(comm, std::move(block));

  const auto error = recovered_error(comm, mesh, "psi");

  const double volume[2] = {1.0 / 6, 2.0 / 6}, slope[2] = {1, 4};
  const double mean = (volume[0] * slope[0] + volume[1] * slope[1]) / (volume[0] + volume[1]);
  for (std::size_t i = 0; i < error.squared.size(); ++i) {
    const auto c = static_cast<std::size_t>(mesh.cell_global[i]);
    const double d = mean - slope[c];
    EXPECT_NEAR(error.squared[i], volume[c] / 20 * 12 * d * d, 1e-13);
  }
  EXPECT_NEAR(error.norm_squared, volume[0] + 16 * volume[1], 1e-13);
}

TEST(AboveMeanShare, MarksCellsOverTheBarOnly) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = mesh_with(comm, front);
  const auto error = recovered_error(comm, mesh, "psi");
  const auto n = mesh.info.n_global_cells;

  const auto few = above_mean_share(error, n, 1.0), many = above_mean_share(error, n, 0.01);

  const auto n_few = count_marked(comm, marks_of(few)), n_many = count_marked(comm, marks_of(many));
  EXPECT_GT(n_few, 0);
  EXPECT_GT(n_many, n_few);
  EXPECT_LT(n_many, n);
  for (std::size_t i = 0; i < few.size(); ++i)
    EXPECT_EQ(few[i] > 0, error.squared[i] > error.norm_squared / static_cast<double>(n));
  EXPECT_THROW(above_mean_share(error, n, 0), Error);
}

TEST(BulkOfError, TakesTheFewestCellsThatCarryTheFraction) {
  par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto mesh = mesh_with(world, front), whole = mesh_with(self, front);
  const auto error = recovered_error(world, mesh, "psi"), twin = recovered_error(self, whole, "psi");
  auto sorted = twin.squared;
  std::sort(sorted.rbegin(), sorted.rend());

  for (const double fraction : {0.0, 0.3, 0.9, 1.0}) {
    const auto chosen = bulk_of_error(world, mesh, error, fraction);
    const auto n = static_cast<std::size_t>(count_marked(world, marks_of(chosen)));
    const double with = std::accumulate(sorted.begin(), sorted.begin() + static_cast<std::ptrdiff_t>(n), 0.0);
    EXPECT_GE(with, fraction * twin.total_squared * (1 - 1e-5));
    if (n > 0) {
      EXPECT_LT(with - sorted[n - 1], fraction * twin.total_squared * (1 + 1e-5));
    }
  }
  EXPECT_THROW(bulk_of_error(world, mesh, error, 1.1), Error);
}

TEST(RecoveredError, RefusesFieldsThatDoNotSuit) {
  par::Comm comm(MPI_COMM_WORLD);
  auto mesh = mesh_with(comm, front, 2);
  EXPECT_THROW(recovered_error(comm, mesh, "phi"), Error);
  for (std::size_t i = 0; i < mesh.node_global.size(); ++i)
    if (mesh.node_global[i] == 2) mesh.node_fields[0].real()[i] = std::numeric_limits<double>::infinity();
  EXPECT_THROW(recovered_error(comm, mesh, "psi"), Error);
}

}  // namespace recovered_error_test
}  // namespace pamr::mark
