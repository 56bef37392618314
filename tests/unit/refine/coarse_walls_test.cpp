// SPDX-License-Identifier: GPL-3.0-or-later
// Walls far too coarse for their curvature, where a map of level 0 places new nodes: shapes, bits, history.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/level0.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/curved/coarse_edges.hpp"
#include "pamr/curved/level0_shapes.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/mesh/tet.hpp"
#include "random_case.hpp"
#include "support/meshes.hpp"
#include "support/places.hpp"
#include "support/reference.hpp"
#include "support/round_bodies.hpp"

namespace pamr {
namespace coarse_walls_test {

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

/// Round bodies whose edges are 0.6 to 1.6 radii long.
std::vector<mesh::BlockMesh> bodies(const par::Comm& self) {
  return {hollow_cube(self, 3), test::gather(self, test::solid_torus(self, 8)), test::gather(self, test::ball(self)),
          test::gather(self, test::domed_cube(self, 3, 0.3))};
}

/// The same cells on any ranks: by numbers.
std::vector<std::uint8_t> mark_some(const mesh::DistMesh& mesh, std::uint64_t seed) {
  std::vector<std::uint8_t> flags;
  for (const auto number : mesh.cell_global)
    flags.push_back(mix(combine(seed, static_cast<std::uint64_t>(number))) % 5 == 0 ? 1 : 0);
  return flags;
}

double worst_of(const mesh::DistMesh& mesh) {
  double worst = 1;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    EXPECT_GT(geometry::orientation(p[0], p[1], p[2], p[3]), 0);
    worst = std::min(worst, geometry::mean_ratio(p));
  }
  return worst;
}

/// The smallest mean ratio that splitting everything into eight, twice, gives.
double uniform_shape(const par::Comm& self, const mesh::BlockMesh& whole) {
  auto mesh = test::scatter(self, whole, 0);
  double worst = worst_of(mesh);
  for (int level = 0; level < 2; ++level) {
    mesh = adapt::refine(self, mesh, std::vector<std::uint8_t>(at(mesh.n_cells()), 1)).mesh;
    worst = std::min(worst, worst_of(mesh));
  }
  return worst;
}

TEST(CoarseWalls, KeepShapesAtEveryLevel) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto all = bodies(self);
  for (std::size_t b = 0; b < all.size(); ++b) {
    SCOPED_TRACE("body " + std::to_string(b));
    const double bound = std::min(0.29, 0.95 * uniform_shape(self, all[b]));
    const auto seed = combine(b, static_cast<std::uint64_t>(world.rank()));
    auto mesh = test::scatter(self, all[b], 0);
    for (std::uint64_t level = 0; level < 4 && mesh.n_cells() < 20000; ++level) {
      auto result = adapt::refine(self, mesh, mark_some(mesh, combine(seed, level)), {.marks_field = ""});
      EXPECT_EQ(result.report.certificate.n_off_surface, 0);
      EXPECT_EQ(result.report.closure.families_kept, 0);
      EXPECT_EQ(result.report.marked_not_split, 0);
      mesh = std::move(result.mesh);
      EXPECT_GE(worst_of(mesh), bound) << "level " << level + 1;
    }
    EXPECT_NE(mesh.info.level0, nullptr);
  }
}

/// Of the cells that descend from bent ones.
double worst_of_bent(const par::Comm& comm, const mesh::DistMesh& mesh) {
  const auto& row = mesh.find_cell_field(mesh::level0_cell_field)->integer();
  double worst = 1;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    if (row[at(c)] >= 0) worst = std::min(worst, geometry::mean_ratio(mesh.points(c)));
  return comm.min(worst);
}

TEST(CoarseWalls, SayBeforehandWhatSplittingIntoEightGives) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  for (const auto& whole : bodies(self)) {
    const auto block = test::cut(comm, whole);
    auto mesh = assemble::assemble(comm, block, test::random_destinations(comm, block, 3));
    auto result = adapt::refine(comm, mesh, std::vector<std::uint8_t>(at(mesh.n_cells()), 1));
    const auto shapes = result.report.level0.shapes;
    EXPECT_GT(shapes.determinant.value, 0);
    EXPECT_GT(shapes.mean_ratio.value, 0);
    for (std::size_t level = 1; level <= 2; ++level) {
      mesh = std::move(result.mesh);
      EXPECT_NEAR(worst_of_bent(comm, mesh), shapes.split[level], 1e-12) << "level " << level;
      if (level == 1) result = adapt::refine(comm, mesh, std::vector<std::uint8_t>(at(mesh.n_cells()), 1));
    }
    EXPECT_LE(shapes.all_splits.value, *std::min_element(shapes.split.begin(), shapes.split.end()));

    const auto later = curved::level0_shapes(comm, *mesh.info.level0),
               alone = curved::level0_shapes(self,
                                             *adapt::refine(self, test::scatter(self, whole, 0),
                                                            std::vector<std::uint8_t>(at(whole.info.n_global_cells), 1))
                                                  .mesh.info.level0);
    for (const auto& same : {later, alone}) {
      EXPECT_EQ(same.determinant, shapes.determinant);
      EXPECT_EQ(same.mean_ratio, shapes.mean_ratio);
      EXPECT_EQ(same.split, shapes.split);
      EXPECT_EQ(same.all_splits, shapes.all_splits);
    }
  }
}

TEST(CoarseWalls, GiveTheSameBitsOnAnyRanksAndWhereverCellsMove) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  for (const auto& whole : bodies(self)) {
    const auto block = test::cut(comm, whole);
    auto spread = assemble::assemble(comm, block, test::random_destinations(comm, block, 7));
    auto serial = test::scatter(self, whole, 0);
    for (std::uint64_t level = 0; level < 3 && serial.n_cells() < 3000; ++level) {
      const auto flags = mark_some(spread, level);
      auto a = level == 1 ? adapt::refine(comm, std::move(spread), flags) : adapt::refine(comm, spread, flags);
      auto b = adapt::refine(self, serial, mark_some(serial, level));
      EXPECT_EQ(a.report.level0.smallest, b.report.level0.smallest);
      EXPECT_EQ(a.report.level0.n_bent_cells, b.report.level0.n_bent_cells);
      spread = std::move(a.mesh);
      serial = std::move(b.mesh);
    }
    const auto a = test::gather(comm, spread), b = test::gather(self, serial);
    EXPECT_TRUE(a.node_position == b.node_position);
    EXPECT_TRUE(a.cell_to_node == b.cell_to_node);
    EXPECT_TRUE(a.cell_to_cell == b.cell_to_cell);
    EXPECT_TRUE(a.lineage == b.lineage);
  }
}

TEST(CoarseWalls, AreCoarsenedBackToLevel0BitByBit) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  for (const auto& whole : bodies(self)) {
    const auto block = test::cut(comm, whole);
    auto mesh = assemble::assemble(comm, block, test::random_destinations(comm, block, 5));
    const auto before = test::gather(comm, mesh);
    for (std::uint64_t level = 0; level < 3 && mesh.info.n_global_cells < 3000; ++level)
      mesh = adapt::refine(comm, mesh, mark_some(mesh, level), {.parent_field = false}).mesh;
    for (int call = 0; call < 4; ++call) {
      adapt::Options options;
      options.refinement.parent_field = false;
      mesh = adapt::adapt(comm, mesh, std::vector<std::int8_t>(at(mesh.n_cells()), -1), options).mesh;
    }
    const auto after = test::gather(comm, mesh);
    EXPECT_TRUE(after.node_position == before.node_position);
    EXPECT_TRUE(after.cell_to_node == before.cell_to_node);
    EXPECT_TRUE(after.cell_to_cell == before.cell_to_cell);
    EXPECT_EQ(mesh.info.level0, nullptr);
    EXPECT_TRUE(mesh.node_fields.empty());
    EXPECT_TRUE(mesh.cell_fields.empty());
  }
}

TEST(CoarseWalls, DoNotShowTheHistoryOfSplits) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  for (const auto& whole : bodies(self)) {
    const auto seed = static_cast<std::uint64_t>(world.rank());
    auto mesh = test::scatter(self, whole, 0);
    for (std::uint64_t level = 0; level < 3 && mesh.n_cells() < 1500; ++level)
      mesh = adapt::refine(self, mesh, mark_some(mesh, combine(seed, level)), {.marks_field = ""}).mesh;
    const auto base = test::places_of_base_cells(test::gather_on(self, mesh, 0));
    const test::Places reached(base.begin(), base.end());

    // the same splits, asked for a few at a time and in another order
    test::Dice dice(mix(seed));
    auto other = test::scatter(self, whole, 0);
    int n_calls = 0;
    for (;; ++n_calls) {
      const auto flags = test::flag_some(test::gather_on(self, other, 0), reached, dice);
      if (std::count(flags.begin(), flags.end(), 1) == 0) break;
      other = adapt::refine(self, other, flags, {.marks_field = ""}).mesh;
      ASSERT_LE(other.n_cells(), mesh.n_cells()) << "more was split than in one go";
    }

    EXPECT_GT(n_calls, 3);
    EXPECT_EQ(test::reference_fingerprint(test::gather_on(self, other, 0)),
              test::reference_fingerprint(test::gather_on(self, mesh, 0)));
  }
}

TEST(CoarseWalls, HaveNoMapWhereEdgesAreShortForTheirCurvature) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto fine = assemble::assemble(comm, test::domed_cube(comm, 2, 0.01));
  const auto coarse = assemble::assemble(comm, test::domed_cube(comm, 2, 0.3));

  EXPECT_EQ(adapt::refine(comm, fine, mark_some(fine, 1)).mesh.info.level0, nullptr);
  EXPECT_EQ(adapt::refine(comm, coarse, mark_some(coarse, 1), {.bend = refine::Bend::none}).mesh.info.level0, nullptr);
  const auto result = adapt::refine(comm, coarse, mark_some(coarse, 1));
  EXPECT_NE(result.mesh.info.level0, nullptr);
  EXPECT_GT(result.report.level0.n_coarse_edges, 0);
  EXPECT_GT(result.report.level0.smallest, result.report.level0.smallest_before);
}

/// A body whose wall nodes do not lie on their walls.
struct BodyOffWalls {
  mesh::BlockMesh whole;
  std::vector<double> off;  ///< of each node
};

/// Wall nodes but those of rims go in or out by up to this part of their shortest edge on the boundary.
BodyOffWalls with_nodes_off(const par::Comm& self, const mesh::BlockMesh& on_walls, double part) {
  auto whole = test::gather(self, assemble::assemble(self, on_walls));  // with neighbors
  std::vector<const geometry::Surface*> surface(whole.node_position.size(), nullptr);
  std::vector<bool> is_on_rim(surface.size(), false);
  std::vector<double> edge(surface.size(), std::numeric_limits<double>::infinity());
  for (std::size_t c = 0; c < whole.cell_to_node.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto next = whole.cell_to_cell[c][f];
      if (next >= 0) continue;
      const auto* of_face = whole.info.surface_of(static_cast<int>(-1 - next));
      for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = 0; j < 4; ++j) {
          if (i == f || j == f || i == j) continue;
          const auto a = at(whole.cell_to_node[c][i]), b = at(whole.cell_to_node[c][j]);
          if (of_face == nullptr)
            is_on_rim[a] = true;
          else
            surface[a] = of_face;
          edge[a] = std::min(edge[a], norm(whole.node_position[b] - whole.node_position[a]));
        }
    }
  BodyOffWalls body{std::move(whole), std::vector<double>(surface.size(), 0.0)};
  for (std::size_t n = 0; n < surface.size(); ++n) {
    if (surface[n] == nullptr || is_on_rim[n]) continue;
    const double share = 0.5 + 0.05 * static_cast<double>(mix(n) % 11);  // up to 1
    auto& p = body.whole.node_position[n];
    const auto before = p;
    p = p + ((mix(n) % 2 == 0 ? 1 : -1) * share * part * edge[n]) * surface[n]->normal(p);
    body.off[n] = norm(p - before);
  }
  return body;
}

void record(BodyOffWalls& body) {
  body.whole.node_fields.push_back({mesh::off_surface_field, "", 1, mesh::StorageType::float64, body.off});
}

GlobalId farthest_off(const BodyOffWalls& body) {
  return std::max_element(body.off.begin(), body.off.end()) - body.off.begin();
}

/// Splits the cells at one node of level 0, level after level.
TEST(CoarseWalls, KeepShapesWhereNodesOfLevel0LieOffThem) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto all = bodies(self);
  for (std::size_t b = 0; b < all.size(); ++b) {
    const double bound = std::min(0.29, 0.9 * uniform_shape(self, all[b]));
    for (const double part : {1e-5, 1e-3, 0.009, 0.05}) {
      SCOPED_TRACE("body " + std::to_string(b) + ", off by " + std::to_string(part));
      auto body = with_nodes_off(self, all[b], part);
      if (part > 0.01) record(body);
      const auto node = farthest_off(body);
      auto mesh = test::scatter(self, body.whole, 0);
      for (int level = 0; level < 9; ++level) {
        std::vector<std::uint8_t> flags;
        for (const auto& nodes : mesh.cell_to_node)
          flags.push_back(
              std::any_of(nodes.begin(), nodes.end(), [&](LocalId n) { return mesh.node_global[at(n)] == node; }));
        auto result = adapt::refine(self, mesh, flags, {.marks_field = ""});
        EXPECT_EQ(result.report.certificate.n_off_surface, 0);
        EXPECT_EQ(result.report.closure.families_kept, 0);
        EXPECT_EQ(result.report.level0.n_moved > 0, level == 0);
        mesh = std::move(result.mesh);
        EXPECT_GE(worst_of(mesh), bound) << "level " << level + 1;
      }
      const auto fine = test::gather(self, mesh);
      for (std::size_t n = 0; n < body.off.size(); ++n)
        EXPECT_NEAR(norm(fine.node_position[n] - body.whole.node_position[n]), body.off[n], 0.1 * body.off[n]);
    }
  }
}

TEST(CoarseWalls, TakeTheirNodesTheSameWayWhetherRecordedOrNot) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  for (const auto& whole : bodies(self)) {
    const auto body = with_nodes_off(self, whole, 0.009);
    auto recorded = body;
    record(recorded);
    const auto block = test::cut(comm, body.whole);
    auto spread = assemble::assemble(comm, block, test::random_destinations(comm, block, 7));
    auto serial = test::scatter(self, recorded.whole, 0);
    for (std::uint64_t level = 0; level < 2; ++level) {
      auto a = adapt::refine(comm, spread, mark_some(spread, level), {.parent_field = false});
      auto b = adapt::refine(self, serial, mark_some(serial, level), {.parent_field = false});
      EXPECT_EQ(a.report.level0.n_moved, b.report.level0.n_moved);
      EXPECT_NEAR(a.report.level0.farthest_moved, b.report.level0.farthest_moved, 1e-6);
      spread = std::move(a.mesh);
      serial = std::move(b.mesh);
    }
    const auto fine = test::gather(comm, spread);
    EXPECT_TRUE(fine.node_position == test::gather(self, serial).node_position);

    // back to level 0, whose nodes stay on the walls; the same again gives the same bits
    for (int call = 0; call < 4; ++call) {
      adapt::Options options;
      options.refinement.parent_field = false;
      spread = adapt::adapt(comm, spread, std::vector<std::int8_t>(at(spread.n_cells()), -1), options).mesh;
    }
    EXPECT_TRUE(test::gather(comm, spread).cell_to_node == body.whole.cell_to_node);
    for (std::uint64_t level = 0; level < 2; ++level) {
      auto result = adapt::refine(comm, spread, mark_some(spread, level), {.parent_field = false});
      EXPECT_EQ(result.report.level0.n_moved, 0);
      spread = std::move(result.mesh);
    }
    EXPECT_TRUE(test::gather(comm, spread).node_position == fine.node_position);
  }
}

TEST(CoarseWalls, LeaveNodesAloneThatLieFarOffThem) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, test::bulging_cube(comm, 3, 0.3));

  const auto result = adapt::refine(comm, mesh, mark_some(mesh, 1));

  EXPECT_THAT(result.report.level0.trouble, testing::HasSubstr("off their coarse walls"));
  EXPECT_EQ(result.report.level0.n_moved, 0);
}

TEST(CoarseWalls, AreFoundBeforeAnythingIsSplit) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto whole = test::gather(self, test::ball(self));
  const auto block = test::cut(comm, whole);
  const auto mesh = assemble::assemble(comm, block, test::random_destinations(comm, block, 3));

  const auto coarse = curved::find_coarse_edges(comm, mesh);

  const double edge = 1 / std::sin(0.4 * std::acos(-1));  // of an icosahedron with the radius 1
  EXPECT_EQ(coarse.count, 30);
  EXPECT_NEAR(coarse.longest, edge, 1e-12);
  EXPECT_NEAR(norm(coarse.where), std::sqrt(1 - 0.25 * edge * edge), 1e-12);
  EXPECT_EQ(std::count(coarse.is_at_cell.begin(), coarse.is_at_cell.end(), 1), mesh.n_cells());
  EXPECT_THAT(curved::text_of(coarse), testing::StartsWith("30 edges in curved walls"));
  EXPECT_THAT(curved::text_of(coarse), testing::Not(testing::HasSubstr("--repair")));
  EXPECT_THAT(curved::text_of({1, 1.18, {}, {}}), testing::HasSubstr("--repair"));
  EXPECT_EQ(curved::find_coarse_edges(comm, adapt::refine(comm, mesh, mark_some(mesh, 1)).mesh).count, 0);
  EXPECT_EQ(curved::find_coarse_edges(comm, assemble::assemble(comm, test::domed_cube(comm, 2, 0.01))).count, 0);
}

TEST(CoarseWalls, AreNamedWhereAMeshWasRefinedWithoutAMap) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto coarse = assemble::assemble(comm, test::domed_cube(comm, 2, 0.3));
  const auto fine = assemble::assemble(comm, test::domed_cube(comm, 2, 0.01));
  const auto again = [&](const mesh::DistMesh& mesh) { return adapt::refine(comm, mesh, mark_some(mesh, 2)); };
  auto without = adapt::refine(comm, coarse, mark_some(coarse, 1), {.bend = refine::Bend::none}).mesh;

  EXPECT_THAT(again(without).report.level0.trouble, testing::HasSubstr("--as-level-0"));
  EXPECT_EQ(again(without).mesh.info.level0, nullptr);
  EXPECT_EQ(again(adapt::refine(comm, coarse, mark_some(coarse, 1)).mesh).report.level0.trouble, "");
  EXPECT_EQ(again(adapt::refine(comm, fine, mark_some(fine, 1)).mesh).report.level0.trouble, "");

  const auto back = adapt::adapt(comm, without, std::vector<std::int8_t>(at(without.n_cells()), -1)).mesh;
  EXPECT_EQ(back.n_cells(), coarse.n_cells());
  EXPECT_NE(again(back).mesh.info.level0, nullptr);
  adapt::make_level0(without);
  EXPECT_NE(again(without).mesh.info.level0, nullptr);
}

}  // namespace coarse_walls_test
}  // namespace pamr
