// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/shape_bound.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "pamr/adapt/adapt.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/uniform_shape.hpp"
#include "pamr/refine/diagonal.hpp"
#include "support/dice.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace shape_bound_test {

using check::worst_uniform_shape;
using geometry::TetPoints;
using geometry::Vec3;
using mesh::worst_uniform_shape;

refine::SplitPoints straight(const TetPoints& corner) {
  refine::SplitPoints points;
  std::copy(corner.begin(), corner.end(), points.begin());
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = mesh::tet::edge_to_corner[e];
    points[4 + e] = geometry::midpoint(corner[at(a)], corner[at(b)]);
  }
  return points;
}

/// The worst mean ratio of a cell and of its inner descendants of so many levels, with the refiner's own diagonals and
/// positions. Corner children have the shape of their parents.
double worst_by_splitting(const TetPoints& corner, int levels) {
  double worst = geometry::mean_ratio(corner);
  if (levels == 0) return worst;
  const auto points = straight(corner);
  const int state = refine::regular_state + refine::choose_diagonal(points, true);
  for (int child = 4; child < 8; ++child)
    worst = std::min(worst, worst_by_splitting(refine::child_points(points, state, child), levels - 1));
  return worst;
}

TetPoints random_tetrahedron(test::Dice& dice) {
  for (;;) {
    TetPoints p;
    for (auto& point : p) point = {dice.unit(), dice.unit(), dice.unit()};
    if (geometry::volume(p) < 0) std::swap(p[0], p[1]);
    if (geometry::mean_ratio(p) > 0.02) return p;
  }
}

TEST(UniformShape, OfTheKuhnCellIsItsOwn) {
  const TetPoints kuhn{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}}};
  const double own = 1.2 * std::cbrt(0.25);  // V = 1/6, squares 1 1 1 2 2 3

  EXPECT_NEAR(worst_uniform_shape(kuhn), own, 1e-12);
  TetPoints small = kuhn;
  for (auto& p : small) p = Vec3{0.3, 0.7, -0.1} + (1.0 / 56) * p;
  EXPECT_NEAR(worst_uniform_shape(small), own, 1e-9);
}

TEST(UniformShape, OfTheRegularTetrahedronIsThatOfItsInnerCells) {
  const TetPoints regular{{{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}}};

  // a quarter of a regular octahedron: five edges as long as each other, one longer by sqrt 2
  EXPECT_NEAR(worst_uniform_shape(regular), 6.0 / 7.0, 1e-12);
  EXPECT_NEAR(worst_uniform_shape({regular[0], regular[2], regular[3], regular[1]}), 6.0 / 7.0, 1e-12);
}

TEST(UniformShape, OfTheCornerOfACubeIsThatOfAnInnerCell) {
  const TetPoints corner{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};

  // at its volume, 1/6, the inner cells have the squares 1 1 1 2 2 3 and 1 1 2 2 2 3; no later one has more
  EXPECT_NEAR(worst_uniform_shape(corner), 12 * std::cbrt(0.25) / 11, 1e-12);
  EXPECT_NEAR(worst_by_splitting(corner, 6), 12 * std::cbrt(0.25) / 11, 1e-12);
}

TEST(UniformShape, OfRandomTetrahedraIsWhatEightLevelsOfSplittingShow) {
  test::Dice dice(15);
  for (int i = 0; i < 40; ++i) {
    const auto corner = random_tetrahedron(dice);
    const double bound = worst_uniform_shape(corner), found = worst_by_splitting(corner, 8);
    EXPECT_NEAR(bound, found, 1e-8 * found) << i << ", mean ratio " << geometry::mean_ratio(corner);
  }
}

TEST(UniformShape, IsNeverUnderThreeQuartersOfTheCellsOwn) {
  test::Dice dice(17);
  double least = 1;
  for (int i = 0; i < 2000; ++i) {
    auto corner = random_tetrahedron(dice);
    for (auto& p : corner) p.z *= i % 2 == 0 ? 1 : 0.01;  // flat ones have many shapes
    least = std::min(least, worst_uniform_shape(corner) / geometry::mean_ratio(corner));
  }
  EXPECT_GT(least, 0.75);
  EXPECT_LT(least, 0.80);
}

TEST(UniformShape, DoesNotDependOnTheOrderOfCornersNorOnSize) {
  test::Dice dice(16);
  for (int i = 0; i < 20; ++i) {
    auto corner = random_tetrahedron(dice);
    const double bound = worst_uniform_shape(corner);
    for (auto& p : corner) p = 1e-6 * p;
    EXPECT_NEAR(worst_uniform_shape({corner[2], corner[0], corner[1], corner[3]}), bound, 1e-9);
    EXPECT_NEAR(worst_uniform_shape({corner[3], corner[2], corner[1], corner[0]}), bound, 1e-9);
  }
}

TEST(UniformShape, OfCellsThatAreNoneIsZero) {
  EXPECT_EQ(worst_uniform_shape({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}}), 0);
  EXPECT_EQ(worst_uniform_shape({{{0, 0, 0}, {0, 1, 0}, {1, 0, 0}, {0, 0, 1}}}), 0);
  EXPECT_EQ(worst_uniform_shape({{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, std::nan("")}}}), 0);
  EXPECT_EQ(worst_uniform_shape({{{0, 0, 0}, {1, 0, 0}, {0, std::numeric_limits<double>::infinity(), 0}, {0, 0, 1}}}),
            0);
}

/// A mesh of random cells, refined where x is small.
mesh::DistMesh refined(const par::Comm& comm, mesh::DistMesh mesh) {
  std::vector<std::uint8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) flags.push_back(mesh.points(c)[0].x < 0.4 ? 1 : 0);
  return adapt::refine(comm, mesh, flags, {.marks_field = ""}).mesh;
}

TEST(UniformShape, OfAMeshIsThatOfItsWorstCellOnAnyRanks) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = test::random_mesh(comm, 3, 3);
  const auto whole = test::gather(comm, block);
  double worst = 1;
  for (const auto& n : whole.cell_to_node) {
    const auto p = [&](std::size_t i) { return whole.node_position[at(n[i])]; };
    worst = std::min(worst, worst_uniform_shape({p(0), p(1), p(2), p(3)}));
  }

  EXPECT_EQ(worst_uniform_shape(comm, assemble::assemble(comm, block)), worst);
}

TEST(UniformShape, OfRefinedMeshesIsThatOfLevelZero) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, test::random_mesh(comm, 4, 2));
  const double bound = worst_uniform_shape(comm, mesh);
  for (int level = 1; level <= 3; ++level) {
    mesh = refined(comm, mesh);
    EXPECT_NEAR(worst_uniform_shape(comm, mesh), bound, 1e-8) << level;
  }
  EXPECT_GT(comm.sum(std::count_if(mesh.lineage.begin(), mesh.lineage.end(), [](auto l) { return l.is_closure(); })),
            0);
}

TEST(ShapeBound, IsTheFloorOrWhatUniformLevelsMakeOrWhatIsThere) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto kuhn = assemble::assemble(comm, test::kuhn_cube(comm, 2));
  const double own = 1.2 * std::cbrt(0.25);

  EXPECT_EQ(check::shape_bound(comm, kuhn, 0).of_all_levels, 0);
  EXPECT_EQ(check::shape_bound(comm, kuhn, 0.5).of_all_levels, 0.5);
  EXPECT_NEAR(check::shape_bound(comm, kuhn, 0.9).of_all_levels, own, 1e-12);
  EXPECT_NEAR(check::shape_bound(comm, kuhn, 0.9).of_uniform_levels, own, 1e-12);

  std::vector<std::uint8_t> flags;
  for (LocalId c = 0; c < kuhn.n_cells(); ++c) flags.push_back(kuhn.cell_global[at(c)] == 0 ? 1 : 0);
  const auto closed =
      adapt::refine(comm, kuhn, flags, {.quality_control = refine::QualityControl::none, .marks_field = ""}).mesh;
  const auto bound = check::shape_bound(comm, closed, 0.9);
  EXPECT_NEAR(bound.of_uniform_levels, own, 1e-12);
  double worst = 1;
  for (LocalId c = 0; c < closed.n_cells(); ++c) worst = std::min(worst, geometry::mean_ratio(closed.points(c)));
  EXPECT_EQ(bound.of_all_levels, comm.min(worst));
  EXPECT_LT(bound.of_all_levels, 0.7);
}

TEST(ShapeBound, HoldsOverSixLevelsOfRandomMarks) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const double floor : {0.0, 0.2, 0.35, 0.5}) {
    auto mesh = assemble::assemble(comm, test::random_mesh(comm, 5, 1));
    const auto bound = check::shape_bound(comm, mesh, floor);
    for (std::uint64_t level = 1; level <= 6; ++level) {
      std::vector<std::uint8_t> flags;
      for (LocalId c = 0; c < mesh.n_cells(); ++c) {
        test::Dice dice(level << 40U ^ static_cast<std::uint64_t>(mesh.cell_global[at(c)]));
        flags.push_back(dice.unit() < 0.15 ? 1 : 0);
      }
      mesh = adapt::refine(comm, mesh, flags, {.shape_floor = floor, .marks_field = ""}).mesh;
      double worst = 1;
      for (LocalId c = 0; c < mesh.n_cells(); ++c) worst = std::min(worst, geometry::mean_ratio(mesh.points(c)));
      EXPECT_GE(comm.min(worst), (1 - 1e-9) * bound.of_all_levels) << floor << ", level " << level;
    }
    EXPECT_GT(mesh.info.n_global_cells, 1000);
  }
}

}  // namespace shape_bound_test
}  // namespace pamr
