// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/curved/curve_cells.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <set>
#include <tuple>

#include "pamr/adapt/adapt.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/mesh/undescribed_patches.hpp"
#include "pamr/par/gather_few.hpp"
#include "support/meshes.hpp"
#include "support/quadratic_cell.hpp"
#include "support/round_bodies.hpp"

namespace pamr {
namespace curve_cells_test {

using geometry::Vec3;

/// A mid-edge node as one rank sees it from one cell.
struct Seen {
  std::array<GlobalId, 2> end{};
  GlobalId node = 0;
  Vec3 position;
  auto key() const { return std::tuple(end, node, position.x, position.y, position.z); }
};

/// What all ranks see, each once.
std::vector<Seen> all_mid_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::SecondOrder& nodes) {
  std::vector<Seen> seen;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t e = 0; e < 6; ++e) {
      const auto [a, b] = mesh::tet::edge_to_corner[e];
      auto first = mesh.node_global[at(mesh.cell_to_node[at(c)][at(a)])];
      auto second = mesh.node_global[at(mesh.cell_to_node[at(c)][at(b)])];
      if (second < first) std::swap(first, second);
      const auto mid = at(nodes.cell_to_mid[at(c)][e]);
      seen.push_back({{first, second}, nodes.node_global[mid], nodes.node_position[mid]});
    }
  seen = par::gather_few(comm, std::move(seen));
  const auto before = [](const Seen& a, const Seen& b) { return a.key() < b.key(); };
  std::sort(seen.begin(), seen.end(), before);
  const auto same = [](const Seen& a, const Seen& b) { return a.key() == b.key(); };
  seen.erase(std::unique(seen.begin(), seen.end(), same), seen.end());
  return seen;
}

/// On ranks drawn for each cell: the borders run everywhere.
mesh::DistMesh scattered(const par::Comm& comm, mesh::BlockMesh block, std::uint64_t seed) {
  const auto destination = test::random_destinations(comm, block, seed);
  return assemble::assemble(comm, std::move(block), destination);
}

double smallest_share(const mesh::DistMesh& mesh, const mesh::SecondOrder& nodes, int n) {
  double smallest = 1;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    smallest = std::min(
        smallest, test::smallest_sample(quadratic_tet(mesh, nodes, c), n) / (6 * geometry::volume(mesh.points(c))));
  return smallest;
}

TEST(CurveCells, GivesEachEdgeOneNodeOfOneNumberOnAllRanks) {
  const par::Comm world(MPI_COMM_WORLD);
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const auto mesh = scattered(world, test::bulging_cube(world, seed, 0.2), seed);

    const auto [nodes, report] = curved::curve_cells(world, mesh);

    const auto seen = all_mid_nodes(world, mesh, nodes);
    std::set<std::array<GlobalId, 2>> edges;
    std::set<GlobalId> numbers;
    for (const auto& mid : seen) {
      EXPECT_TRUE(edges.insert(mid.end).second) << "two nodes on one edge";
      EXPECT_TRUE(numbers.insert(mid.node).second) << "one node on two edges";
    }
    ASSERT_FALSE(numbers.empty());
    EXPECT_EQ(*numbers.begin(), mesh.info.n_global_nodes);
    EXPECT_EQ(*numbers.rbegin() + 1, nodes.n_global_nodes);
    EXPECT_EQ(std::ssize(numbers), report.n_edges);
    EXPECT_EQ(nodes.n_global_nodes, mesh.info.n_global_nodes + report.n_edges);
    for (LocalId n = 0; n < mesh.n_nodes(); ++n) {
      EXPECT_EQ(nodes.node_position[at(n)], mesh.point(n));
      EXPECT_EQ(nodes.node_global[at(n)], mesh.node_global[at(n)]);
    }
  }
}

TEST(CurveCells, GivesTheSameOnAnyNumberOfRanks) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  int n_straightened = 0;
  for (const std::uint64_t seed : {4U, 5U, 6U, 7U}) {
    const double bulge = 0.1 * static_cast<double>(seed - 3);
    const auto alone = assemble::assemble(self, test::bulging_cube(self, seed, bulge));
    const auto mesh = scattered(world, test::bulging_cube(world, seed, bulge), seed);

    const auto here = curved::curve_cells(world, mesh), there = curved::curve_cells(self, alone);

    const auto mine = all_mid_nodes(world, mesh, here.nodes), expected = all_mid_nodes(self, alone, there.nodes);
    ASSERT_EQ(mine.size(), expected.size());
    for (std::size_t i = 0; i < mine.size(); ++i) ASSERT_EQ(mine[i].key(), expected[i].key());
    const auto &a = here.report, &b = there.report;
    EXPECT_EQ(a.n_curved_edges, b.n_curved_edges);
    EXPECT_EQ(a.n_curved_cells, b.n_curved_cells);
    EXPECT_EQ(a.n_off_surface, b.n_off_surface);
    EXPECT_EQ(a.max_off_surface, b.max_off_surface);
    EXPECT_EQ(a.straightening.n_edges, b.straightening.n_edges);
    EXPECT_EQ(a.straightening.n_cells, b.straightening.n_cells);
    EXPECT_EQ(a.straightening.n_cut, b.straightening.n_cut);
    EXPECT_EQ(a.straightening.min_jacobian, b.straightening.min_jacobian);
    EXPECT_EQ(a.straightening.rounds, b.straightening.rounds);
    n_straightened += a.straightening.n_edges > 0 ? 1 : 0;
  }
  EXPECT_GT(n_straightened, 1);
}

TEST(CurveCells, StraightensCellsThatWouldFoldUntilAllArePositive) {
  const par::Comm world(MPI_COMM_WORLD);
  for (const std::uint64_t seed : {8U, 9U}) {
    const auto mesh = scattered(world, test::bulging_cube(world, seed, 0.45), seed);

    const auto [nodes, report] = curved::curve_cells(world, mesh);

    EXPECT_GT(report.straightening.n_cells, 0);
    EXPECT_GT(report.straightening.n_edges, 0);
    EXPECT_GT(report.n_off_surface, 0);
    EXPECT_GE(report.straightening.min_jacobian, 0.1);
    EXPECT_GE(world.min(smallest_share(mesh, nodes, 10)), report.straightening.min_jacobian);
    // what is not on its surface is in the field, with the right distance; everything else lies on it
    const auto* off = &nodes.node_fields.front();
    ASSERT_EQ(off->name, mesh::off_surface_field);
    const auto& dome = *mesh.info.surfaces->get(0);
    for (LocalId c = 0; c < mesh.n_cells(); ++c)
      for (std::size_t f = 0; f < 4; ++f) {
        const auto slot = mesh.cell_to_cell[at(c)][f];
        if (slot >= 0 || mesh.info.patches[at(mesh::slot_to_patch(slot))].name != "zmin") continue;
        for (std::size_t e = 0; e < 6; ++e) {
          if ((mesh::tet::face_edge_mask[f] >> e & 1U) == 0) continue;
          const auto mid = at(nodes.cell_to_mid[at(c)][e]);
          EXPECT_NEAR(off->real()[mid], dome.distance(nodes.node_position[mid]), 1e-12);
        }
      }
  }
}

TEST(CurveCells, StraightensACoarseMeshAroundASmallSphere) {
  const par::Comm world(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(world, test::tetrahedral_shell(world, 5));
  for (int level = 0; level < 4; ++level) {
    const auto [nodes, report] = curved::curve_cells(world, mesh);

    const auto& straightening = report.straightening;
    EXPECT_GE(straightening.n_edges, report.n_off_surface);
    EXPECT_GE(straightening.min_jacobian, 0.1);
    EXPECT_GE(world.min(smallest_share(mesh, nodes, 8)), straightening.min_jacobian);
    if (level == 0) {
      EXPECT_EQ(straightening.n_edges, 6);
      EXPECT_EQ(straightening.n_cells, 8);
      EXPECT_EQ(report.n_off_surface, 6);
    }
    mesh = adapt::refine(world, mesh, std::vector<std::uint8_t>(at(mesh.n_cells()), 1), {.parent_field = false}).mesh;
  }
}

TEST(CurveCells, CurvesNothingThatItNeedNotStraighten) {
  const par::Comm world(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(world, test::ball(world));

  const auto [nodes, report] = curved::curve_cells(world, mesh);

  EXPECT_EQ(report.n_edges, 42);
  EXPECT_EQ(report.n_curved_edges, 30);  // the edges to the center are straight
  EXPECT_EQ(report.n_curved_cells, 20);
  EXPECT_EQ(report.straightening.n_edges, 0);
  EXPECT_EQ(report.n_off_surface, 0);
  EXPECT_TRUE(nodes.node_fields.empty());
  for (const auto& mid : all_mid_nodes(world, mesh, nodes))
    EXPECT_NEAR(norm(mid.position), mid.end[0] == 0 ? 0.5 : 1, 1e-15);
}

TEST(CurveCells, KeepsPatchesThatNobodyDescribedFlat) {
  const par::Comm world(MPI_COMM_WORLD);
  const auto mesh = scattered(world, test::bulging_cube(world, 10, 0.1), 10);

  const auto nodes = curved::curve_cells(world, mesh).nodes;

  int n_checked = 0;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto slot = mesh.cell_to_cell[at(c)][f];
      if (slot >= 0) continue;
      const auto& name = mesh.info.patches[at(mesh::slot_to_patch(slot))].name;
      if (name == "zmin") continue;
      for (std::size_t e = 0; e < 6; ++e) {
        if ((mesh::tet::face_edge_mask[f] >> e & 1U) == 0) continue;
        const auto axis = static_cast<std::size_t>(name[0] - 'x');
        EXPECT_NEAR(nodes.node_position[at(nodes.cell_to_mid[at(c)][e])][axis], name.ends_with("max") ? 1 : 0, 1e-14);
        ++n_checked;
      }
    }
  EXPECT_GT(world.sum(n_checked), 100);
}

TEST(CurveCells, GivesFieldsOnNodesTheMeanOfTheEnds) {
  const par::Comm world(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(world, test::kuhn_cube(world, 3));
  std::vector<double> height;
  for (const auto p : mesh.node_position) height.push_back(3 * p.z - p.x);
  mesh.node_fields.push_back({"height", "m", 1, mesh::StorageType::float64, height});

  const auto nodes = curved::curve_cells(world, mesh).nodes;

  ASSERT_EQ(nodes.node_fields.size(), 1U);
  ASSERT_EQ(nodes.node_fields[0].real().size(), nodes.node_position.size());
  for (std::size_t n = 0; n < nodes.node_position.size(); ++n)
    EXPECT_NEAR(nodes.node_fields[0].real()[n], 3 * nodes.node_position[n].z - nodes.node_position[n].x, 1e-14);
}

/// Flat cells on a ball: the half x < 1/2 of their lower side is the patch `ball` on it, the patch `zmin` continues it
/// without a surface.
mesh::BlockMesh half_described_disk(const par::Comm& comm) {
  constexpr double radius = 8, thickness = 0.01;
  auto block = test::kuhn_cube(comm, 4);
  const auto whole = test::gather(comm, block);
  const auto zmin = std::find_if(block.info.patches.begin(), block.info.patches.end(),
                                 [](const auto& patch) { return patch.name == "zmin"; }) -
                    block.info.patches.begin();
  const auto ball = std::ssize(block.info.patches);
  for (std::size_t c = 0; c < block.cell_to_cell.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      double x = 0;
      for (const auto corner : mesh::tet::face_to_corner[f])
        x += whole.node_position[at(block.cell_to_node[c][at(corner)])].x / 3;
      auto& slot = block.cell_to_cell[c][f];
      if (slot == -zmin - 1 && x < 0.5) slot = -ball - 1;
    }
  for (auto& p : block.node_position) {
    const double u = p.x - 0.5, v = p.y - 0.5;
    p.z = thickness * p.z + std::sqrt(radius * radius - u * u - v * v) - radius;
  }
  block.info.patches.push_back({"ball", "", 0});
  block.info.surfaces =
      test::surfaces_of("[[surface]]\nname = \"ball\"\nkind = \"sphere\"\ncenter = [0.5, 0.5, -8]\nradius = 8\n");
  return block;
}

TEST(CurveCells, RecordsHowFarAStraightenedEdgeLeavesItsFacets) {
  const par::Comm world(MPI_COMM_WORLD);
  const auto mesh = scattered(world, half_described_disk(world), 11);

  const auto nodes = curved::curve_cells(world, mesh).nodes;

  const auto field = std::find_if(nodes.node_fields.begin(), nodes.node_fields.end(),
                                  [](const auto& f) { return f.name == mesh::off_facets_field; });
  ASSERT_NE(field, nodes.node_fields.end());
  int n_off = 0, n_straightened = 0;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto slot = mesh.cell_to_cell[at(c)][f];
      if (slot >= 0 || mesh.info.patches[at(mesh::slot_to_patch(slot))].name != "zmin") continue;
      const auto& corner = mesh::tet::face_to_corner[f];
      const auto p = mesh.points(c);
      const auto normal = cross(p[at(corner[1])] - p[at(corner[0])], p[at(corner[2])] - p[at(corner[0])]);
      for (std::size_t e = 0; e < 6; ++e) {
        if ((mesh::tet::face_edge_mask[f] >> e & 1U) == 0) continue;
        const auto [a, b] = mesh::tet::edge_to_corner[e];
        const auto mid = at(nodes.cell_to_mid[at(c)][e]);
        const auto moved = nodes.node_position[mid] - geometry::midpoint(p[at(a)], p[at(b)]);
        const double off = std::abs(dot(moved, normal)) / norm(normal);
        EXPECT_NEAR(field->real()[mid], off, 1e-12);
        if (off < 1e-9) continue;
        ++n_off;
        n_straightened += std::abs(norm(nodes.node_position[mid] - Vec3{0.5, 0.5, -8}) - 8) > 1e-9 ? 1 : 0;
      }
    }
  EXPECT_EQ(world.sum(n_off), 4);
  EXPECT_GT(world.sum(n_straightened), 0);
}

TEST(CurveCells, RefusesCellsThatTheRoundingOfTheirMiddlesInverts) {
  const par::Comm world(MPI_COMM_WORLD);
  const double far = 0x1p52;  // where doubles are one apart
  const auto mesh = assemble::assemble(
      world, test::small_mesh(world, {{far, far, far}, {far + 1, far, far}, {far, far + 1, far}, {far, far, far + 1}},
                              {{0, 1, 2, 3}}));

  EXPECT_THROW(curved::curve_cells(world, mesh), Error);
  EXPECT_THROW(curved::curve_cells(world, mesh, {.min_jacobian = 0}), Error);
}

}  // namespace curve_cells_test
}  // namespace pamr
