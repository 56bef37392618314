// SPDX-License-Identifier: GPL-3.0-or-later
// Volumes and areas of smooth bodies by cells of second order, on meshes refined uniformly from one.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "pamr/adapt/adapt.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/index.hpp"
#include "pamr/curved/curve_cells.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "support/quadratic_cell.hpp"
#include "support/round_bodies.hpp"

namespace pamr {
namespace curved_convergence_test {

struct Measures {
  double volume = 0, area = 0;
};

Measures measure(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::SecondOrder& nodes) {
  std::array<par::ExactSum, 2> sum;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto tet = quadratic_tet(mesh, nodes, c);
    sum[0].add(test::quadratic_volume(tet));
    for (std::size_t f = 0; f < 4; ++f)
      if (mesh.cell_to_cell[at(c)][f] < 0) sum[1].add(test::quadratic_face_area(tet, mesh::tet::face_to_corner[f]));
  }
  const auto total = par::reproducible_sums(comm, sum);
  return {total[0], total[1]};
}

/// Errors of volume and area relative to the exact ones, level by level.
std::vector<Measures> errors(const par::Comm& comm, mesh::BlockMesh block, int n_levels, Measures exact) {
  auto mesh = assemble::assemble(comm, std::move(block));
  std::vector<Measures> result;
  for (int level = 0; level <= n_levels; ++level) {
    const auto [nodes, report] = curved::curve_cells(comm, mesh);
    EXPECT_EQ(report.straightening.n_edges, 0) << "level " << level;
    const auto found = measure(comm, mesh, nodes);
    result.push_back({found.volume / exact.volume - 1, found.area / exact.area - 1});
    if (level < n_levels)
      mesh = adapt::refine(comm, mesh, std::vector<std::uint8_t>(at(mesh.n_cells()), 1), {.parent_field = false}).mesh;
  }
  return result;
}

void expect_order_4(const std::vector<Measures>& errors) {
  for (std::size_t level = 1; level < errors.size(); ++level) {
    const auto &coarse = errors[level - 1], &fine = errors[level];
    const double of_volume = std::log2(coarse.volume / fine.volume), of_area = std::log2(coarse.area / fine.area);
    EXPECT_NEAR(of_volume, 4, level == 1 ? 0.6 : 0.25) << "level " << level << " " << fine.volume;
    EXPECT_NEAR(of_area, 4, level == 1 ? 0.6 : 0.25) << "level " << level << " " << fine.area;
  }
}

TEST(CurvedConvergence, OfVolumeAndAreaOfABallIsOfOrderFour) {
  const par::Comm world(MPI_COMM_WORLD);
  const double pi = std::numbers::pi;
  expect_order_4(errors(world, test::ball(world), 3, {4 * pi / 3, 4 * pi}));
}

TEST(CurvedConvergence, OfVolumeAndAreaOfATorusIsOfOrderFour) {
  const par::Comm world(MPI_COMM_WORLD);
  const double pi = std::numbers::pi;
  expect_order_4(errors(world, test::solid_torus(world, 14), 2, {2 * pi * pi * 0.16, 4 * pi * pi * 0.4}));
}

}  // namespace curved_convergence_test
}  // namespace pamr
