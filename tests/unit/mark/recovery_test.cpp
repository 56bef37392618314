// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mark/recovery.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>

#include "pamr/assemble/assemble.hpp"
#include "pamr/mesh/borders.hpp"
#include "support/meshes.hpp"

namespace pamr::mark {
namespace recovery_test {

using geometry::Vec3;

/// The cube with planes between its cells that come closer towards its corner at 0, the outermost layers of cells
/// differing by about `ratio` in thickness; scattered over the ranks.
mesh::DistMesh graded_mesh(const par::Comm& comm, double ratio, int n = 6) {
  auto block = test::kuhn_cube(comm, n);
  for (auto& p : block.node_position)
    for (std::size_t k = 0; k < 3; ++k) p[k] = ratio == 1 ? p[k] : std::expm1(std::log(ratio) * p[k]) / (ratio - 1);
  const auto destination = test::random_destinations(comm, block, 5);
  return assemble::assemble(comm, std::move(block), destination);
}

std::vector<double> volumes_of(const mesh::DistMesh& mesh) {
  std::vector<double> volume;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) volume.push_back(geometry::volume(mesh.points(c)));
  return volume;
}

/// A vector for each cell from its number.
std::vector<Vec3> values_of(const mesh::DistMesh& mesh) {
  std::vector<Vec3> value;
  for (const auto cell : mesh.cell_global) {
    const auto of = [cell](GlobalId factor) { return 1 + static_cast<double>(cell * factor % 1009) / 1009; };
    value.push_back({of(577), -1e9 * of(331), 1e-9 * of(797)});
  }
  return value;
}

template <class Value>
std::vector<Value> means(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<Value>& value) {
  const auto borders = mesh::find_borders(comm, mesh);
  return nodal_means<Value>(par::Exchange(comm, borders.nodes), mesh.node_position.size(), mesh.cell_to_node,
                            volumes_of(mesh), value);
}

std::vector<Vec3> recovered_gradient(const par::Comm& comm, const mesh::DistMesh& mesh, double (*f)(Vec3)) {
  const auto volume = volumes_of(mesh);
  std::vector<Vec3> gradient;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    gradient.push_back(linear_gradient(p, {f(p[0]), f(p[1]), f(p[2]), f(p[3])}, volume[at(c)]));
  }
  return means(comm, mesh, gradient);
}

double largest_difference(Vec3 a, Vec3 b) {
  return std::max({std::abs(a.x - b.x), std::abs(a.y - b.y), std::abs(a.z - b.z)});
}

TEST(NodalMeans, AgreeWithPlainSumsOnStronglyGradedMeshes) {
  const par::Comm self(MPI_COMM_SELF);
  const auto mesh = graded_mesh(self, 1e9);
  const auto volume = volumes_of(mesh);
  const auto value = values_of(mesh);
  ASSERT_GT(*std::max_element(volume.begin(), volume.end()), 1e20 * *std::min_element(volume.begin(), volume.end()));

  const auto mean = means(self, mesh, value);

  std::vector<std::array<long double, 4>> sum(mean.size(), std::array<long double, 4>{});
  for (std::size_t c = 0; c < volume.size(); ++c)
    for (const auto node : mesh.cell_to_node[c]) {
      sum[at(node)][3] += volume[c];
      for (std::size_t k = 0; k < 3; ++k) sum[at(node)][k] += static_cast<long double>(volume[c]) * value[c][k];
    }
  for (std::size_t n = 0; n < mean.size(); ++n)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto expected = static_cast<double>(sum[n][k] / sum[n][3]);
      ASSERT_NEAR(mean[n][k], expected, 5e-14 * std::abs(expected));
    }
}

TEST(NodalMeans, HaveTheSameBitsForEveryNumberOfRanks) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto shared = graded_mesh(world, 1e6), whole = graded_mesh(self, 1e6);

  const auto mean = means(world, shared, values_of(shared)), twin = means(self, whole, values_of(whole));

  std::vector<Vec3> of_number(twin.size());
  for (std::size_t n = 0; n < twin.size(); ++n) of_number[at(whole.node_global[n])] = twin[n];
  for (std::size_t n = 0; n < mean.size(); ++n)
    for (std::size_t k = 0; k < 3; ++k)
      ASSERT_EQ(std::bit_cast<std::uint64_t>(mean[n][k]),
                std::bit_cast<std::uint64_t>(of_number[at(shared.node_global[n])][k]));
}

TEST(NodalMeans, RecoverTheGradientOfALinearFieldExactly) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto block = test::random_mesh(comm, 7, 4);
  const auto destination = test::random_destinations(comm, block, 8);
  for (const auto& mesh : {graded_mesh(comm, 1000), assemble::assemble(comm, std::move(block), destination)})
    for (const auto g : recovered_gradient(comm, mesh, [](Vec3 p) { return 2 * p.x - p.y + 0.5 * p.z; }))
      ASSERT_LT(largest_difference(g, {2, -1, 0.5}), 1e-11);
}

TEST(NodalMeans, RecoverTheGradientOfASmoothFieldToSecondOrder) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto worst_error = [&](int n) {
    const auto mesh = graded_mesh(comm, 1, n);
    const auto gradient =
        recovered_gradient(comm, mesh, [](Vec3 p) { return std::sin(2 * p.x + p.y) * std::exp(p.z); });
    double worst = 0;
    for (std::size_t i = 0; i < gradient.size(); ++i) {
      const auto p = mesh.node_position[i];
      if (std::min({p.x, p.y, p.z, 1 - p.x, 1 - p.y, 1 - p.z}) < 1e-9) continue;  // one-sided: first order
      const double c = std::cos(2 * p.x + p.y) * std::exp(p.z), s = std::sin(2 * p.x + p.y) * std::exp(p.z);
      worst = std::max(worst, largest_difference(gradient[i], {2 * c, c, s}));
    }
    return comm.max(worst);
  };

  const double coarse = worst_error(8), fine = worst_error(16);

  EXPECT_LT(fine, 0.03);
  EXPECT_NEAR(std::log2(coarse / fine), 2, 0.2) << coarse << " " << fine;
}

TEST(IntegralOfProduct, IsThatOfTheLinearFields) {
  // Unit tetrahedron with corners 0, ex, ey, ez.
  const double volume = 1.0 / 6;
  const std::array<Vec3, 4> x{Vec3{}, Vec3{1, 0, 0}, Vec3{}, Vec3{}}, y{Vec3{}, Vec3{}, Vec3{1, 0, 0}, Vec3{}};
  const Vec3 unit{1, 0, 0};

  EXPECT_NEAR(integral_of_product(volume, x, x), 1.0 / 60, 1e-16);
  EXPECT_NEAR(integral_of_product(volume, x, y), 1.0 / 120, 1e-16);
  EXPECT_NEAR(integral_of_product(volume, x, {unit, unit, unit, unit}), 1.0 / 24, 1e-16);
}

}  // namespace recovery_test
}  // namespace pamr::mark
