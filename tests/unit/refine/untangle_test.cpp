// SPDX-License-Identifier: GPL-3.0-or-later
// Walls far too coarse for their curvature: a ball known by the eight corners of a cube.
#include "pamr/refine/untangle.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "pamr/adapt/adapt.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/refine/movable.hpp"
#include "support/meshes.hpp"
#include "support/reference.hpp"

namespace pamr {
namespace untangle_test {

constexpr std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// The unit cube in n^3 cubes of six cells without the one in the middle, through whose corners the sphere `ball` goes:
/// edges on it are 1.15 and 1.63 radii long. n is odd. The outer sides are the patch `box`.
mesh::BlockMesh hollow_cube(const par::Comm& self, int n) {
  auto whole = test::gather(self, test::kuhn_cube(self, n));
  const auto is_inside = [&](GlobalId c) {
    geometry::Vec3 centroid;
    for (const auto node : whole.cell_to_node[at(c)]) centroid = centroid + 0.25 * whole.node_position[at(node)];
    return std::max({std::abs(centroid.x - 0.5), std::abs(centroid.y - 0.5), std::abs(centroid.z - 0.5)}) < 0.5 / n;
  };
  std::vector<std::array<GlobalId, 4>> cells;
  for (GlobalId c = 0; c < whole.info.n_global_cells; ++c)
    if (!is_inside(c)) cells.push_back(whole.cell_to_node[at(c)]);
  auto hollow = test::small_mesh(self, whole.node_position, cells);
  hollow.cell_to_cell = test::reference_neighbors(hollow.cell_to_node);
  for (std::size_t c = 0; c < cells.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      if (hollow.cell_to_cell[c][f] >= 0) continue;
      const auto on_box = [&](GlobalId node) {
        const auto p = whole.node_position[at(node)];
        return std::min({p.x, p.y, p.z}) == 0 || std::max({p.x, p.y, p.z}) == 1;
      };
      hollow.cell_to_cell[c][f] = -1;
      for (std::size_t k = 0; k < 4; ++k)
        if (k != f && !on_box(cells[c][k])) hollow.cell_to_cell[c][f] = -2;
    }
  hollow.info.patches = {{"box", "wall"}, {"ball", "wall", 0}};
  hollow.info.surfaces =
      test::surfaces_of("[[surface]]\nname = \"ball\"\nkind = \"sphere\"\ncenter = [0.5, 0.5, 0.5]\nradius = " +
                        std::to_string(std::sqrt(3.0) / 2 / n) + "\n");
  return hollow;
}

std::vector<std::uint8_t> at_ball(const mesh::DistMesh& mesh) {
  std::vector<std::uint8_t> flags;
  for (const auto& next : mesh.cell_to_cell)
    flags.push_back(std::find(next.begin(), next.end(), mesh::patch_to_slot(1)) != next.end() ? 1 : 0);
  return flags;
}

TEST(Untangling, BringsEveryNodeOfABallKnownByEightCornersOntoItOnAnyRanks) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto whole = hollow_cube(self, 3);
  const auto block = test::cut(comm, whole);
  auto spread = assemble::assemble(comm, block, test::random_destinations(comm, block, 7));
  auto serial = assemble::assemble(self, test::cut(self, whole));
  std::int64_t rounds = 0;

  for (int level = 0; level < 3; ++level) {
    auto a = adapt::refine(comm, spread, at_ball(spread), {.marks_field = ""});
    auto b = adapt::refine(self, serial, at_ball(serial), {.marks_field = ""});
    EXPECT_EQ(a.report.certificate.n_off_surface, 0);
    EXPECT_EQ(a.report.marked_not_split, 0);
    EXPECT_EQ(a.report.certificate.untangling_rounds, b.report.certificate.untangling_rounds);
    rounds += a.report.certificate.untangling_rounds;
    spread = std::move(a.mesh);
    serial = std::move(b.mesh);
  }

  EXPECT_GT(rounds, 0);
  for (LocalId c = 0; c < spread.n_cells(); ++c) {
    const auto p = spread.points(c);
    ASSERT_GT(geometry::orientation(p[0], p[1], p[2], p[3]), 0);
  }
  const auto a = test::gather(comm, spread), b = test::gather(self, serial);
  EXPECT_TRUE(a.node_position == b.node_position);
  EXPECT_TRUE(a.cell_to_node == b.cell_to_node);
  EXPECT_TRUE(a.cell_to_cell == b.cell_to_cell);
  EXPECT_TRUE(a.lineage == b.lineage);
}

TEST(Untangling, RatesACellByItsShapeAndAnInvertedOneByHowFarItIsTurned) {
  const geometry::TetPoints corner{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
  auto turned = corner, flat = corner, far = corner;
  turned[3].z = -1;
  flat[3].z = 0;
  far[3].z = -0.5;

  EXPECT_DOUBLE_EQ(std::cbrt(15552 * refine::untangle_key(corner)), geometry::mean_ratio(corner));
  EXPECT_EQ(refine::untangle_key(flat), 0);
  EXPECT_LT(refine::untangle_key(turned), refine::untangle_key(far));
  EXPECT_LT(refine::untangle_key(far), 0);
}

TEST(Untangling, RatesAFamilyByTheWorstChildOfItsParent) {
  refine::SplitPoints parent;
  parent[0] = {0, 0, 0}, parent[1] = {1, 0, 0}, parent[2] = {0, 1, 0}, parent[3] = {0, 0, 1};
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = mesh::tet::edge_to_corner[e];
    parent[4 + e] = geometry::midpoint(parent[at(a)], parent[at(b)]);
  }
  auto bent = parent;
  bent[4] = {0.5, -0.6, -0.6};

  EXPECT_GT(refine::untangle_key(parent), 0);
  EXPECT_LT(refine::untangle_key(bent), refine::untangle_key(parent));
  bent[4] = {0.5, 0.6, 0.6};  // through the opposite side
  EXPECT_LT(refine::untangle_key(bent), 0);
}

}  // namespace untangle_test
}  // namespace pamr
