// SPDX-License-Identifier: GPL-3.0-or-later
// Curved boundaries, most of them far too curved for the mesh: new nodes want to go through whole cells.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "pamr/adapt/adapt.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/refine/movable.hpp"
#include "random_case.hpp"
#include "support/meshes.hpp"
#include "support/reference.hpp"

namespace pamr {
namespace project_test {

/// A random cube whose patch zmin is tied to a sphere that bulges into it by `bulge`, and xmin to a plane.
mesh::BlockMesh bulging_cube(const par::Comm& comm, std::uint64_t seed, double bulge) {
  auto block = test::random_mesh(comm, seed, 3);
  const double radius = (0.5 + bulge * bulge) / (2 * bulge);  // through the corners of the face, highest in its middle
  block.info.surfaces = test::surfaces_of("[[surface]]\nname = \"dome\"\nkind = \"sphere\"\ncenter = [0.5, 0.5, " +
                                          std::to_string(bulge - radius) + "]\nradius = " + std::to_string(radius) +
                                          "\n[[surface]]\nname = \"side\"\nkind = \"plane\"\npoint = [0.0, 0.0, 0.0]\n"
                                          "normal = [1.0, 0.0, 0.0]\n");
  for (auto& patch : block.info.patches) {
    if (patch.name == "zmin") patch.surface = 0;
    if (patch.name == "xmin") patch.surface = 1;
  }
  return block;
}

std::vector<std::uint8_t> near_dome(const mesh::DistMesh& mesh, double height) {
  std::vector<std::uint8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    flags.push_back(0.25 * (p[0].z + p[1].z + p[2].z + p[3].z) < height ? 1 : 0);
  }
  return flags;
}

void expect_all_positive(const mesh::DistMesh& mesh) {
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    ASSERT_GT(geometry::orientation(p[0], p[1], p[2], p[3]), 0);
  }
}

void expect_conforming(const mesh::BlockMesh& whole) {
  const auto reference = test::reference_neighbors(whole.cell_to_node);
  for (std::size_t c = 0; c < reference.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f) ASSERT_EQ(std::max<GlobalId>(whole.cell_to_cell[c][f], -1), reference[c][f]);
}

/// Expects every new node of a boundary face to be on the surface of its patch or in the ledger, and every node in the
/// ledger to be listed with a distance. A face may lie on another rank than the nodes it shares.
void expect_honest_ledger(const mesh::DistMesh& mesh, GlobalId n_level_0) {
  const auto* ledger = mesh.find_node_field(mesh::off_surface_field);
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int f = 0; f < 4; ++f) {
      const auto slot = mesh.cell_to_cell[static_cast<std::size_t>(c)][static_cast<std::size_t>(f)];
      if (slot >= 0) continue;
      const auto* surface = mesh.info.surface_of(mesh::slot_to_patch(slot));
      if (surface == nullptr) continue;
      for (const auto corner : mesh::tet::face_to_corner[static_cast<std::size_t>(f)]) {
        const auto node = mesh.cell_to_node[static_cast<std::size_t>(c)][static_cast<std::size_t>(corner)];
        if (mesh.node_global[static_cast<std::size_t>(node)] < n_level_0) continue;
        const double distance = surface->distance(mesh.point(node));
        const double listed = ledger == nullptr ? 0 : ledger->real()[static_cast<std::size_t>(node)];
        ASSERT_TRUE(distance <= 1e-12 || listed >= distance) << "node " << node << " is " << distance << " off";
      }
    }
}

TEST(Projection, PutsEveryNewNodeOfAGentleDomeOnIt) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const std::uint64_t seed : {1U, 2U}) {
    auto mesh = assemble::assemble(comm, bulging_cube(comm, seed, 0.02));
    const auto n_level_0 = mesh.info.n_global_nodes;
    for (int level = 0; level < 3; ++level) {
      auto result = adapt::refine(comm, mesh, near_dome(mesh, 0.15), {.marks_field = ""});
      mesh = std::move(result.mesh);
      expect_all_positive(mesh);
      EXPECT_EQ(result.report.certificate.n_off_surface, 0);
      expect_honest_ledger(mesh, n_level_0);
      EXPECT_EQ(mesh.find_node_field(mesh::off_surface_field), nullptr);
    }
    expect_conforming(test::gather(comm, mesh));
  }
}

TEST(Projection, NeverTurnsACellOverAndListsWhatItLeavesOff) {
  const par::Comm comm(MPI_COMM_WORLD);
  bool saw_ledger = false;
  std::vector<std::pair<double, std::uint64_t>> cases{{0.6, 3}};
  if (comm.size() == 1 || test::is_full_level()) cases.insert(cases.end(), {{0.3, 1}, {0.6, 2}});
  for (const auto& [bulge, seed] : cases) {
    auto mesh = assemble::assemble(comm, bulging_cube(comm, seed, bulge));
    const auto n_level_0 = mesh.info.n_global_nodes;
    for (int level = 0; level < 3; ++level) {
      auto result = adapt::refine(comm, mesh, near_dome(mesh, 0.2), {.marks_field = ""});
      mesh = std::move(result.mesh);
      expect_all_positive(mesh);
      expect_honest_ledger(mesh, n_level_0);
      EXPECT_EQ(result.report.marked_not_split, 0);
      EXPECT_EQ(result.report.certificate.n_off_surface > 0, mesh.find_node_field(mesh::off_surface_field) != nullptr);
      saw_ledger = saw_ledger || result.report.certificate.n_off_surface > 0;
    }
    expect_conforming(test::gather(comm, mesh));
  }
  EXPECT_TRUE(saw_ledger);
}

TEST(Projection, GivesTheSameBitsForAnyDistribution) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  for (const auto& [bulge, seed] : std::vector<std::pair<double, std::uint64_t>>{{0.1, 4}, {0.6, 5}}) {
    const auto block = bulging_cube(comm, seed, bulge);
    auto spread = assemble::assemble(comm, block, test::random_destinations(comm, block, seed));
    auto serial = assemble::assemble(self, test::cut(self, test::gather(comm, block)));
    std::int64_t kept = 0, kept_serial = 0;
    for (int level = 0; level < (test::is_full_level() ? 3 : 2); ++level) {
      auto a = adapt::refine(comm, spread, near_dome(spread, 0.25), {.marks_field = ""});
      auto b = adapt::refine(self, serial, near_dome(serial, 0.25), {.marks_field = ""});
      kept += a.report.closure.families_kept;
      kept_serial += b.report.closure.families_kept;
      spread = std::move(a.mesh);
      serial = std::move(b.mesh);
    }
    const auto a = test::gather(comm, spread), b = test::gather(self, serial);
    EXPECT_TRUE(a.node_position == b.node_position);
    EXPECT_TRUE(a.cell_to_node == b.cell_to_node);
    EXPECT_TRUE(a.cell_to_cell == b.cell_to_cell);
    EXPECT_TRUE(a.lineage == b.lineage);
    EXPECT_EQ(kept, kept_serial);
  }
}

TEST(Projection, LetsNewNodesOfAPlaneFollowTheWallWithinThePlane) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, bulging_cube(comm, 2, 0.1));
  const auto flags = near_dome(mesh, 0.4);

  const auto moved = test::gather(comm, adapt::refine(comm, mesh, flags, {.shape_floor = 0, .marks_field = ""}).mesh);
  const auto straight = test::gather(
      comm, adapt::refine(comm, mesh, flags, {.shape_floor = 0, .project = false, .marks_field = ""}).mesh);

  ASSERT_EQ(moved.node_position.size(), straight.node_position.size());
  int n_followed = 0;
  for (std::size_t n = 0; n < moved.node_position.size(); ++n) {
    const auto before = straight.node_position[n], now = moved.node_position[n];
    if (before.x != 0 || before.z == 0) continue;  // not on the plane, or at the dome
    EXPECT_EQ(now.x, 0);
    n_followed += now == before ? 0 : 1;
  }
  EXPECT_GT(n_followed, 0);
}

TEST(Projection, LeavesFacesBetweenRegionsAsTheyAre) {
  const par::Comm comm(MPI_COMM_WORLD);
  for (const auto& [bulge, seed] : std::vector<std::pair<double, std::uint64_t>>{{0.1, 2}, {0.5, 3}}) {
    auto mesh = assemble::assemble(comm, bulging_cube(comm, seed, bulge));
    std::vector<std::int64_t> region;
    for (LocalId c = 0; c < mesh.n_cells(); ++c) {
      const auto p = mesh.points(c);
      region.push_back(p[0].y + p[1].y + p[2].y + p[3].y < 2 ? 3 : 7);
    }
    mesh.cell_fields.push_back({mesh::region_field, "", 1, mesh::StorageType::int64, region});
    const auto flags = near_dome(mesh, 0.6);

    const auto moved = test::gather(comm, adapt::refine(comm, mesh, flags, {.shape_floor = 0, .marks_field = ""}).mesh);
    const auto straight = test::gather(
        comm, adapt::refine(comm, mesh, flags, {.shape_floor = 0, .project = false, .marks_field = ""}).mesh);

    const auto& regions = std::find_if(moved.cell_fields.begin(), moved.cell_fields.end(), [](const auto& field) {
                            return field.name == mesh::region_field;
                          })->integer();
    ASSERT_EQ(moved.node_position.size(), straight.node_position.size());
    int n_between = 0, n_moved = 0;
    for (std::size_t c = 0; c < moved.cell_to_node.size(); ++c)
      for (std::size_t f = 0; f < 4; ++f) {
        const auto next = moved.cell_to_cell[c][f];
        const bool is_between = next >= 0 && regions[static_cast<std::size_t>(next)] != regions[c];
        for (const auto corner : mesh::tet::face_to_corner[f]) {
          const auto node = static_cast<std::size_t>(moved.cell_to_node[c][static_cast<std::size_t>(corner)]);
          const auto before = straight.node_position[node], now = moved.node_position[node];
          if (before.z == 0) continue;  // at the dome
          n_moved += now == before ? 0 : 1;
          if (!is_between) continue;
          ++n_between;
          EXPECT_TRUE(now == before);
        }
      }
    EXPECT_GT(n_between, 20);
    EXPECT_GT(n_moved, 20);
  }
}

double min_volume_at(const mesh::BlockMesh& whole, GlobalId node) {
  double least = 1;
  for (const auto& nodes : whole.cell_to_node)
    if (std::find(nodes.begin(), nodes.end(), node) != nodes.end()) {
      geometry::TetPoints p;
      for (std::size_t i = 0; i < 4; ++i) p[i] = whole.node_position[static_cast<std::size_t>(nodes[i])];
      least = std::min(least, geometry::volume(p));
    }
  return least;
}

/// A refined mesh whose closure midpoints were moved as far as its cells stay positive: as walls do that bend strongly.
mesh::BlockMesh strained_mesh(const par::Comm& self, std::uint64_t seed) {
  auto mesh = assemble::assemble(self, test::random_mesh(self, seed, 3));
  std::vector<std::uint8_t> flags;
  for (const auto id : mesh.cell_global)
    flags.push_back(combine(seed, static_cast<std::uint64_t>(id)) % 8 == 0 ? 1 : 0);
  const auto n_old = mesh.info.n_global_nodes;
  auto whole = test::gather(self, adapt::refine(self, mesh, flags, {.parent_field = false, .marks_field = ""}).mesh);
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> component(-0.12, 0.12);
  for (auto node = n_old; node < whole.info.n_global_nodes; ++node)
    for (int attempt = 0; attempt < 4; ++attempt) {
      auto& at = whole.node_position[static_cast<std::size_t>(node)];
      const auto before = at;
      at = at + geometry::Vec3{component(random), component(random), component(random)};
      if (min_volume_at(whole, node) < 1e-6) at = before;
    }
  return whole;
}

TEST(Families, AreKeptWhereTheirParentCannotBeRebuiltAndTheMeshStaysConforming) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  std::int64_t kept = 0, rebuilt = 0;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    const auto whole = strained_mesh(self, seed);
    const auto block = test::cut(comm, whole);
    auto spread = assemble::assemble(comm, block, test::random_destinations(comm, block, seed));
    auto serial = assemble::assemble(self, test::cut(self, whole));
    for (int level = 0; level < 2; ++level) {
      const auto flag = [&](const mesh::DistMesh& mesh) {
        std::vector<std::uint8_t> flags;
        for (const auto id : mesh.cell_global)
          flags.push_back(combine(seed + 5, static_cast<std::uint64_t>(id)) % 6 == 0 ? 1 : 0);
        return flags;
      };
      auto a = adapt::refine(comm, spread, flag(spread), {.marks_field = ""});
      auto b = adapt::refine(self, serial, flag(serial), {.marks_field = ""});
      EXPECT_EQ(a.report.closure.families_kept, b.report.closure.families_kept);
      EXPECT_EQ(a.report.marked_not_split, 0);
      kept += a.report.closure.families_kept;
      rebuilt += a.report.closure.families_rebuilt;
      spread = std::move(a.mesh);
      serial = std::move(b.mesh);
      expect_all_positive(spread);
    }
    const auto a = test::gather(comm, spread), b = test::gather(self, serial);
    expect_conforming(a);
    EXPECT_TRUE(a.node_position == b.node_position && a.cell_to_node == b.cell_to_node);
    EXPECT_TRUE(a.cell_to_cell == b.cell_to_cell && a.lineage == b.lineage);
  }
  EXPECT_GT(kept, 0);
  EXPECT_GT(rebuilt, 0);
}

}  // namespace project_test
}  // namespace pamr
