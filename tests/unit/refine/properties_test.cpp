// SPDX-License-Identifier: GPL-3.0-or-later
// What every refinement keeps or gives, property by property, on random meshes, marks and policies. The checks use maps
// and whole numbers, nothing of the library's own validation.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <map>
#include <set>
#include <string>

#include "exact_mesh.hpp"
#include "pamr/adapt/adapt.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/check/shape_bound.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "random_case.hpp"
#include "support/delaunay.hpp"
#include "support/meshes.hpp"
#include "support/places.hpp"
#include "support/reference.hpp"

namespace pamr {
namespace properties_test {

using geometry::Vec3;
using refine::QualityControl;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// One level of one random case.
struct Level {
  const mesh::BlockMesh& start;  ///< before the first level
  mesh::BlockMesh before, after;
  test::Law law{};
  std::uint64_t seed = 0;  ///< of the marks
  std::vector<std::uint8_t> flags;
  QualityControl policy{};
  adapt::Report report;
  const mesh::DistMesh& fine;  ///< `after` as it came, with fields
};

QualityControl policy_of(std::uint64_t seed) { return static_cast<QualityControl>(seed % 4); }

test::Law law_of(std::uint64_t seed, int level) { return test::law_of(seed / 4 + at(level)); }

adapt::Result refine_once(const par::Comm& comm, const mesh::DistMesh& mesh, std::uint64_t seed, int level,
                          QualityControl policy) {
  const auto flags = test::mark(mesh, law_of(seed, level), combine(seed, at(level)));
  return adapt::refine(comm, mesh, flags, {.quality_control = policy, .marks_field = ""});
}

/// Visits the levels of random cases; each rank has cases of its own and is alone with them. The quick level leaves
/// most cases to the run on one rank.
template <class Make, class Check>
void on_random_levels(Make&& make_mesh, Check&& check) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  for (const auto i : test::seeds_alone(world)) {
    const mesh::BlockMesh start = make_mesh(i);
    auto mesh = test::scatter(self, start, 0);
    for (int level = 0; level < 3 && mesh.n_cells() < 2000; ++level) {
      SCOPED_TRACE("mesh " + std::to_string(i) + ", level " + std::to_string(level));
      auto fine = refine_once(self, mesh, i, level, policy_of(i));
      Level made{start,
                 test::gather_on(self, mesh, 0),
                 test::gather_on(self, fine.mesh, 0),
                 law_of(i, level),
                 combine(i, at(level)),
                 {},
                 policy_of(i),
                 fine.report,
                 fine.mesh};
      made.flags = test::mark(mesh, made.law, made.seed);
      check(made);
      if (testing::Test::HasFailure()) return;
      mesh = std::move(fine.mesh);
    }
  }
}

mesh::BlockMesh any_mesh(std::uint64_t seed) { return test::random_delaunay(seed); }
mesh::BlockMesh whole_numbered_mesh(std::uint64_t seed) { return test::random_delaunay(seed, true); }

geometry::TetPoints points_of(const mesh::BlockMesh& whole, std::size_t cell) {
  const auto& n = whole.cell_to_node[cell];
  const auto& p = whole.node_position;
  return {p[at(n[0])], p[at(n[1])], p[at(n[2])], p[at(n[3])]};
}

std::set<std::set<GlobalId>> edges_of(const mesh::BlockMesh& whole) {
  std::set<std::set<GlobalId>> edges;
  for (const auto& n : whole.cell_to_node)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = i + 1; j < 4; ++j) edges.insert({n[i], n[j]});
  return edges;
}

Vec3 middle_of(const mesh::BlockMesh& whole, const std::set<GlobalId>& edge) {
  return geometry::midpoint(whole.node_position[at(*edge.begin())], whole.node_position[at(*edge.rbegin())]);
}

std::map<std::set<GlobalId>, std::vector<std::pair<GlobalId, std::size_t>>> faces_of(const mesh::BlockMesh& whole) {
  std::map<std::set<GlobalId>, std::vector<std::pair<GlobalId, std::size_t>>> faces;
  for (std::size_t c = 0; c < whole.cell_to_node.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      std::set<GlobalId> face(whole.cell_to_node[c].begin(), whole.cell_to_node[c].end());
      face.erase(whole.cell_to_node[c][f]);
      faces[face].push_back({static_cast<GlobalId>(c), f});
    }
  return faces;
}

/// All that a mesh is, byte after byte.
std::string bytes_of(const mesh::BlockMesh& whole) {
  auto bytes = test::bytes_of(whole);
  for (const auto& field : whole.cell_fields) test::append_bytes(field.integer(), bytes);
  return bytes;
}

TEST(P1Conformity, EveryFaceBelongsToTwoCellsOrToThePatchesAndNoNodeHangsOnAnEdge) {
  on_random_levels(any_mesh, [](const Level& level) {
    for (const auto& [face, cells] : faces_of(level.after)) {
      ASSERT_LE(cells.size(), 2U);
      for (const auto& [cell, slot] : cells)
        ASSERT_EQ(level.after.cell_to_cell[at(cell)][slot] < 0, cells.size() == 1) << "cell " << cell;
    }
    std::set<Vec3, test::BeforeInSpace> nodes(level.after.node_position.begin(), level.after.node_position.end());
    ASSERT_EQ(nodes.size(), level.after.node_position.size()) << "two nodes in one place";
    for (const auto& edge : edges_of(level.after)) ASSERT_EQ(nodes.count(middle_of(level.after, edge)), 0U);
  });
}

TEST(P2Neighbors, PointBackAcrossTheSameFaceOrNameAPatch) {
  on_random_levels(any_mesh, [](const Level& level) {
    for (const auto& [face, cells] : faces_of(level.after))
      for (std::size_t i = 0; i < cells.size(); ++i) {
        const auto [cell, slot] = cells[i];
        const auto neighbor = level.after.cell_to_cell[at(cell)][slot];
        if (cells.size() == 2)
          ASSERT_EQ(neighbor, cells[1 - i].first);
        else
          ASSERT_TRUE(neighbor <= -1 && neighbor >= -static_cast<GlobalId>(level.after.info.patches.size()));
      }
  });
}

TEST(P3Orientation, IsPositiveByExactArithmetic) {
  on_random_levels(whole_numbered_mesh, [](const Level& level) {
    const auto point = test::to_whole(level.after.node_position);
    for (const auto& cell : level.after.cell_to_node) ASSERT_TRUE(test::six_volumes(point, cell) > 0);
  });
  on_random_levels(any_mesh, [](const Level& level) {
    for (std::size_t c = 0; c < level.after.cell_to_node.size(); ++c) {
      const auto p = points_of(level.after, c);
      ASSERT_GT(geometry::exact_orientation(p[0], p[1], p[2], p[3]), 0);
    }
  });
}

/// The cells that are replaced together: a family that may be taken back, or a cell. By their first one.
GlobalId group_of(const Level& level, GlobalId old_cell) {
  const auto lineage = level.before.lineage[at(old_cell)];
  const bool is_together = level.policy == QualityControl::removable && lineage.is_removable();
  return is_together ? old_cell - lineage.child() : old_cell;
}

TEST(P4Volume, IsKeptByEachCellOrFamilyExactlyAndByTheWholeToRounding) {
  on_random_levels(whole_numbered_mesh, [](const Level& level) {
    const auto old_point = test::to_whole(level.before.node_position),
               point = test::to_whole(level.after.node_position);
    std::map<GlobalId, test::Wide> gained;
    for (std::size_t c = 0; c < level.before.cell_to_node.size(); ++c)
      gained[group_of(level, static_cast<GlobalId>(c))] -= test::six_volumes(old_point, level.before.cell_to_node[c]);
    for (std::size_t c = 0; c < level.after.cell_to_node.size(); ++c)
      gained[group_of(level, level.after.cell_fields.front().integer()[c])] +=
          test::six_volumes(point, level.after.cell_to_node[c]);
    for (const auto& [group, gain] : gained) ASSERT_TRUE(gain == 0) << "old cell " << group;
  });
  on_random_levels(any_mesh, [](const Level& level) {
    const double volume = test::reference_volume(level.start);
    ASSERT_NEAR(test::reference_volume(level.after), volume, 1e-12 * volume);
  });
}

TEST(P5Area, OfEachPatchIsKept) {
  on_random_levels(whole_numbered_mesh, [](const Level& level) {
    std::map<std::pair<int, std::size_t>, test::Wide> gained;  // by patch and direction
    const auto add = [&gained](const mesh::BlockMesh& whole, int sign) {
      const auto point = test::to_whole(whole.node_position);
      for (const auto& face : test::boundary_of(whole)) {
        const auto area = test::area_vector(point, face.corner);
        for (std::size_t i = 0; i < 3; ++i) gained[{face.patch, i}] += sign * area[i];
      }
    };
    add(level.before, -1);
    add(level.after, 1);
    for (const auto& [where, gain] : gained) ASSERT_TRUE(gain == 0) << "patch " << where.first;
  });
  on_random_levels(any_mesh, [](const Level& level) {
    const auto before = test::reference_patch_areas(level.start), after = test::reference_patch_areas(level.after);
    for (std::size_t p = 0; p < before.size(); ++p) ASSERT_NEAR(after[p], before[p], 1e-12 * (1 + before[p]));
  });
}

TEST(P6Tags, OfTheFacesThatTheMeshBeganWithCoverTheirParts) {
  on_random_levels(whole_numbered_mesh, [](const Level& level) {
    const auto old_point = test::to_whole(level.start.node_position), point = test::to_whole(level.after.node_position);
    const auto corners = [](const std::vector<test::WholePoint>& p, const test::BoundaryFace& f) {
      return std::array<test::WholePoint, 3>{p[at(f.corner[0])], p[at(f.corner[1])], p[at(f.corner[2])]};
    };
    const auto old_faces = test::boundary_of(level.start);
    std::set<int> old_tags, tags;
    for (const auto& face : old_faces) old_tags.insert(face.patch);
    for (const auto& face : test::boundary_of(level.after)) {
      tags.insert(face.patch);
      const auto holds_it = [&](const test::BoundaryFace& old) {
        return old.patch == face.patch && test::lies_in(corners(point, face), corners(old_point, old));
      };
      ASSERT_TRUE(std::any_of(old_faces.begin(), old_faces.end(), holds_it));
    }
    ASSERT_EQ(tags, old_tags);
    ASSERT_TRUE(level.after.info.patches == level.start.info.patches);
  });
}

/// Every node of the patches tied to the surface lies on it or is listed with its distance. Adds up the nodes.
void expect_on_sphere(const Level& level, const std::string& surface, Vec3 center, double radius,
                      std::size_t& n_nodes) {
  const auto* ledger = level.fine.find_node_field("off_surface");
  std::set<LocalId> nodes;
  for (LocalId c = 0; c < level.fine.n_cells(); ++c)
    for (std::size_t f = 0; f < 4; ++f) {
      const auto slot = level.fine.cell_to_cell[at(c)][f];
      if (slot >= 0) continue;
      const auto& info = level.fine.info;
      if (info.surface_name(info.patches[at(mesh::slot_to_patch(slot))]) != surface) continue;
      for (std::size_t i = 0; i < 4; ++i)
        if (i != f) nodes.insert(level.fine.cell_to_node[at(c)][i]);
    }
  std::int64_t n_off = 0;
  for (const auto node : nodes) {
    const double distance = std::abs(norm(level.fine.point(node) - center) - radius);
    const double listed = ledger == nullptr ? 0 : ledger->real()[at(node)];
    n_off += listed > 0 ? 1 : 0;
    ASSERT_NEAR(distance, listed, 1e-12 * 2 * radius) << "node " << node;
  }
  ASSERT_EQ(level.report.certificate.n_off_surface, n_off);
  n_nodes += nodes.size();
}

TEST(P7CurvedBoundary, HoldsEveryNodeThatIsNotInTheLedger) {
  std::size_t n_on_dome = 0, n_on_ball = 0;
  on_random_levels(test::random_dome, [&](const Level& level) {
    expect_on_sphere(level, "dome", {0, 0, -4}, 4, n_on_dome);
  });
  on_random_levels(test::random_ball, [&](const Level& level) {
    expect_on_sphere(level, "ball", {0, 0, 0}, 1, n_on_ball);
    for (std::size_t c = 0; c < level.after.cell_to_node.size(); ++c) {
      const auto p = points_of(level.after, c);
      ASSERT_GT(geometry::exact_orientation(p[0], p[1], p[2], p[3]), 0);
    }
  });
  const par::Comm world(MPI_COMM_WORLD);
  EXPECT_GT(world.sum(static_cast<std::int64_t>(n_on_dome)), 100);
  EXPECT_GT(world.sum(static_cast<std::int64_t>(n_on_ball)), 100);
}

TEST(P8RankIndependence, GivesTheBytesAndFingerprintOfOneRankForAnyDistribution) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto size = static_cast<std::uint64_t>(world.size());
  const auto n_cases = test::n_cases_together(world);
  const auto mesh_of = [](std::uint64_t i) { return i % 5 == 0 ? test::random_dome(i) : test::random_delaunay(i); };
  std::string bytes;
  std::uint64_t fingerprint = 0;
  for (std::uint64_t i = 0; i < n_cases; ++i) {
    SCOPED_TRACE("mesh " + std::to_string(i));
    // each rank works out its next case alone, then all go through them together
    if (i % size == 0 && i + static_cast<std::uint64_t>(world.rank()) < n_cases) {
      const auto mine = i + static_cast<std::uint64_t>(world.rank());
      auto mesh = test::scatter(self, mesh_of(mine), 0);
      for (int level = 0; level < 2; ++level) mesh = refine_once(self, mesh, mine, level, policy_of(mine)).mesh;
      const auto whole = test::gather_on(self, mesh, 0);
      bytes = bytes_of(whole);
      fingerprint = test::reference_fingerprint(whole);
    }
    const auto root = static_cast<Rank>(i % size);
    auto mesh = test::scatter(world, mesh_of(i), i);
    for (int level = 0; level < 2; ++level) mesh = refine_once(world, mesh, i, level, policy_of(i)).mesh;
    const auto whole = test::gather_on(world, mesh, root);
    const auto found = mesh::fingerprint(world, mesh);
    if (world.rank() == root) {
      EXPECT_TRUE(bytes_of(whole) == bytes) << "the bytes differ";
      EXPECT_EQ(found, fingerprint);
    }
    if (world.any(testing::Test::HasFailure())) return;
  }
}

TEST(P9Permutation, OfCellsNodesAndCornersLeavesTheFingerprint) {
  const par::Comm self(MPI_COMM_SELF);
  on_random_levels(any_mesh, [&](const Level& level) {
    const auto seed = static_cast<std::uint64_t>(level.report.cells_out);
    const auto permuted = test::permute(self, level.before, seed);
    auto mesh = assemble::assemble(self, permuted);
    const auto flags = test::mark(mesh, level.law, level.seed);
    const auto fine = adapt::refine(self, mesh, flags, {.quality_control = level.policy, .marks_field = ""});
    ASSERT_EQ(mesh::fingerprint(self, fine.mesh), test::reference_fingerprint(level.after));
  });
}

TEST(P10Repeat, GivesTheSamePartsOnTheSameRanks) {
  const par::Comm world(MPI_COMM_WORLD);
  const auto n_cases = test::n_cases_together(world);
  for (std::uint64_t i = 0; i < n_cases; ++i) {
    const auto mesh = test::scatter(world, test::random_delaunay(i), i);
    const auto first = refine_once(world, mesh, i, 0, policy_of(i)).mesh;
    const auto second = refine_once(world, mesh, i, 0, policy_of(i)).mesh;
    EXPECT_TRUE(first.node_position == second.node_position && first.node_global == second.node_global);
    EXPECT_TRUE(first.cell_to_node == second.cell_to_node && first.cell_to_cell == second.cell_to_cell);
    EXPECT_TRUE(first.cell_global == second.cell_global && first.lineage == second.lineage);
    EXPECT_TRUE(first.border_face == second.border_face && first.ghost_global == second.ghost_global);
    if (world.any(testing::Test::HasFailure())) return;
  }
}

double worst_mean_ratio(const mesh::DistMesh& mesh) {
  double worst = 1;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) worst = std::min(worst, geometry::mean_ratio(mesh.points(c)));
  return worst;
}

/// Cells about as near to a point as they are large: at every level the same few dozen.
std::vector<std::uint8_t> mark_near(const mesh::DistMesh& mesh, Vec3 target) {
  std::vector<std::uint8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    double nearest = norm(p[0] - target), size = 0;
    for (std::size_t i = 1; i < 4; ++i) {
      nearest = std::min(nearest, norm(p[i] - target));
      size = std::max(size, norm(p[i] - p[0]));
    }
    flags.push_back(nearest < 0.7 * size ? 1 : 0);
  }
  return flags;
}

TEST(P11Quality, StaysAboveTheBoundOverSixLevelsOfRemovableFamilies) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  std::int64_t n_deep = 0;
  double min_relative = 9;
  for (const auto i : test::seeds_alone(world)) {
    auto mesh = test::scatter(self, test::random_delaunay(i), 0);
    const auto target = mesh.point(0);
    const double bound = std::min(refine::default_shape_floor, check::worst_uniform_shape(self, mesh));
    for (int level = 1; level <= 6 && mesh.n_cells() < 10000; ++level) {
      auto fine = adapt::refine(self, mesh, mark_near(mesh, target),
                                {.quality_control = QualityControl::removable, .marks_field = ""})
                      .mesh;
      const double relative = worst_mean_ratio(fine) / bound;
      EXPECT_GE(relative, 1 - 1e-7) << "mesh " << i << ", level " << level;
      min_relative = std::min(min_relative, relative);
      n_deep += level == 6 ? 1 : 0;
      mesh = std::move(fine);
    }
  }
  EXPECT_GT(world.sum(n_deep), 0);
  min_relative = world.min(min_relative);
  if (world.is_first()) std::printf("smallest mean ratio over the bound: %.6f\n", min_relative);
}

TEST(P12Idempotence, NothingMarkedChangesNothing) {
  const par::Comm self(MPI_COMM_SELF);
  on_random_levels(any_mesh, [&](const Level& level) {
    const std::vector<std::uint8_t> nothing(at(level.fine.n_cells()), 0);
    const auto same =
        adapt::refine(self, level.fine, nothing, {.quality_control = level.policy, .marks_field = ""}).mesh;
    auto before = level.after, after = test::gather_on(self, same, 0);
    before.cell_fields.clear();
    after.cell_fields.clear();
    ASSERT_TRUE(bytes_of(before) == bytes_of(after));
  });
}

TEST(P12Idempotence, AllMarkedMakesEightOfEachAgainAndAgain) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  for (const auto i : test::seeds_alone(world)) {
    auto mesh = test::scatter(self, test::random_delaunay(i), 0);
    for (int level = 0; level < 2; ++level) {
      const std::vector<std::uint8_t> all(at(mesh.n_cells()), 1);
      const auto expected = 8 * mesh.info.n_global_cells;
      mesh = adapt::refine(self, mesh, all, {.quality_control = policy_of(i), .marks_field = ""}).mesh;
      ASSERT_EQ(mesh.info.n_global_cells, expected);
      for (const auto lineage : mesh.lineage)
        ASSERT_TRUE(!lineage.is_closure() && lineage.level() == level + 1 && lineage.depth() == level + 1);
    }
  }
}

/// Nodes - edges + faces - cells.
std::int64_t euler_characteristic(const mesh::BlockMesh& whole) {
  return static_cast<std::int64_t>(whole.node_position.size()) - static_cast<std::int64_t>(edges_of(whole).size()) +
         static_cast<std::int64_t>(faces_of(whole).size()) - static_cast<std::int64_t>(whole.cell_to_node.size());
}

TEST(P13Counts, AreThoseOfTheSplitEdgesAndCellsAndKeepTheEulerCharacteristic) {
  on_random_levels(any_mesh, [](const Level& level) {
    ASSERT_EQ(euler_characteristic(level.after), euler_characteristic(level.start));
    std::set<Vec3, test::BeforeInSpace> nodes(level.after.node_position.begin(), level.after.node_position.end());
    std::int64_t split_edges = 0;
    for (const auto& edge : edges_of(level.before))
      split_edges += static_cast<std::int64_t>(nodes.count(middle_of(level.before, edge)));
    // early passes make edges, and may halve them
    const bool is_one_pass = level.report.closure.early_passes == 0;
    if (is_one_pass)
      ASSERT_EQ(level.report.nodes_out, level.report.nodes_in + split_edges);
    else
      ASSERT_GE(level.report.nodes_out, level.report.nodes_in + split_edges);

    std::map<GlobalId, std::int64_t> became, members;  // by group
    std::set<GlobalId> flagged;
    for (std::size_t c = 0; c < level.flags.size(); ++c) {
      ++members[group_of(level, static_cast<GlobalId>(c))];
      if (level.flags[c] != 0) flagged.insert(group_of(level, static_cast<GlobalId>(c)));
    }
    for (const auto parent : level.after.cell_fields.front().integer()) ++became[group_of(level, parent)];
    for (const auto& [group, n] : became) {
      const bool is_allowed = level.policy == QualityControl::removable
                                  ? (n <= 8 || members[group] > 1 || !is_one_pass) && (n > 1 || members[group] == 1)
                                  : std::set<std::int64_t>{1, 2, 4, 8}.count(n) != 0;
      ASSERT_TRUE(is_allowed) << group << " became " << n;
      ASSERT_TRUE(flagged.count(group) == 0 || n >= 8) << group << " was marked and became " << n;
    }
    ASSERT_EQ(became.size(), members.size()) << "a cell is gone without children";
    ASSERT_EQ(level.report.cells_out, static_cast<std::int64_t>(level.after.cell_to_node.size()));
    ASSERT_EQ(level.report.marked_not_split, 0);
  });
}

}  // namespace properties_test
}  // namespace pamr
