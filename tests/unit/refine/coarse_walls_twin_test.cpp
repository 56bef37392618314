// SPDX-License-Identifier: GPL-3.0-or-later
// The refiner against its slow, obvious twin near coarse curved walls, where a map of level 0 places new nodes; and
// what is bent in that map.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "expect_same.hpp"
#include "pamr/adapt/adapt.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/geometry/orientation.hpp"
#include "random_case.hpp"
#include "support/meshes.hpp"
#include "support/reference_refine.hpp"
#include "support/round_bodies.hpp"

namespace pamr {
namespace coarse_walls_twin_test {

using refine::QualityControl;

constexpr int n_levels = 3;
constexpr GlobalId enough_cells = 1500;  ///< no further level on larger meshes: the twin is slow

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// All sides but `zmin` become one patch, which then is not flat and gets no surface. Turned about the axis of the
/// dome, so that coordinates in its sides are not exact.
mesh::BlockMesh with_one_side(mesh::BlockMesh block) {
  for (auto& p : block.node_position) {
    const double x = p.x - 0.5, y = p.y - 0.5;
    p.x = 0.5 + std::cos(0.3) * x - std::sin(0.3) * y;
    p.y = 0.5 + std::sin(0.3) * x + std::cos(0.3) * y;
  }
  GlobalId dome = 0;
  while (block.info.patches[at(dome)].name != "zmin") ++dome;
  const GlobalId side = dome == 0 ? 1 : 0;
  for (auto& neighbors : block.cell_to_cell)
    for (auto& neighbor : neighbors)
      if (neighbor < 0 && neighbor != -1 - dome) neighbor = -1 - side;
  return block;
}

/// Cubes with a dome and flat sides that get planes, or none; a ball; a torus.
mesh::BlockMesh start_of(const par::Comm& comm, std::uint64_t seed) {
  const double bulge = 0.15 + 0.05 * static_cast<double>(mix(seed) % 4);
  if (seed % 4 == 0) return test::domed_cube(comm, seed, bulge);
  if (seed % 4 == 1) return with_one_side(test::domed_cube(comm, seed, bulge));
  if (seed % 4 == 2) return test::permute(comm, test::ball(comm), seed);
  return test::permute(comm, test::solid_torus(comm, 10), seed);
}

refine::Options options_of(std::uint64_t seed) {
  constexpr std::array<double, 4> floors{0.3, 0, 0.5, 0.68};
  const bool is_other = seed % 7 == 6;
  const auto policy = is_other ? static_cast<QualityControl>(mix(seed) % 3) : QualityControl::removable;
  return {.quality_control = policy, .shape_floor = floors[at(mix(seed + 1) % 4)], .marks_field = ""};
}

test::SurfaceOfPatch surfaces_of_patches(const mesh::MeshInfo& info) {
  test::SurfaceOfPatch surfaces;
  for (std::size_t p = 0; p < info.patches.size(); ++p) surfaces.push_back(info.surface_of(static_cast<int>(p)));
  return surfaces;
}

/// The rows of all ranks on one, ascending. Collective.
std::vector<mesh::Level0Cell> rows_on(const par::Comm& comm, const mesh::Level0Map& map, Rank root) {
  const std::vector<mesh::Level0Cell> here(map.cells().begin(), map.cells().end());
  auto rows = comm.sparse_exchange<mesh::Level0Cell>({{root, here}}).item;
  std::sort(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.row < b.row; });
  rows.erase(std::unique(rows.begin(), rows.end(), [](const auto& a, const auto& b) { return a.row == b.row; }),
             rows.end());
  return rows;
}

/// But for the bulges of edges that are in no curved wall.
void expect_same_map(const std::vector<mesh::Level0Cell>& found, const std::vector<mesh::Level0Cell>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t r = 0; r < found.size(); ++r) {
    SCOPED_TRACE("row " + std::to_string(r));
    const auto &f = found[r], &e = expected[r];
    ASSERT_EQ(f.row, e.row);
    ASSERT_EQ(f.node, e.node);
    ASSERT_EQ(f.corner, e.corner);
    ASSERT_EQ(f.face_patch, e.face_patch);
    ASSERT_EQ(f.edge_patch, e.edge_patch);
    ASSERT_EQ(f.sharp_edges, e.sharp_edges);
    ASSERT_EQ(f.bent_corners, e.bent_corners);
    for (std::size_t i = 0; i < 6; ++i) {
      if (e.edge_patch[i][0] < 0) continue;
      ASSERT_EQ(f.bulge[i], e.bulge[i]);
      ASSERT_EQ(f.beside[i], e.beside[i]);
    }
  }
}

/// What the fields of the map say of all cells and nodes, by number.
struct Fields {
  std::vector<GlobalId> row;
  std::vector<mesh::Level0Key> key;
};

/// On one rank. Collective.
Fields fields_on(const par::Comm& comm, const mesh::DistMesh& mesh, Rank root) {
  struct CellRow {
    GlobalId id, row;
  };
  struct NodeRow {
    GlobalId id;
    mesh::Level0Key key;
  };
  const auto* rows = mesh.find_cell_field(mesh::level0_cell_field);
  const auto* keys = mesh.find_node_field(mesh::level0_key_field);
  std::vector<CellRow> cells;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) cells.push_back({mesh.cell_global[at(c)], rows->integer()[at(c)]});
  std::vector<NodeRow> nodes;
  for (LocalId n = 0; n < mesh.n_nodes(); ++n) nodes.push_back({mesh.node_global[at(n)], mesh::key_of(keys, n)});
  Fields fields;
  for (const auto& [id, row] : comm.sparse_exchange<CellRow>({{root, cells}}).item) {
    if (fields.row.size() <= at(id)) fields.row.resize(at(id) + 1);
    fields.row[at(id)] = row;
  }
  for (const auto& [id, key] : comm.sparse_exchange<NodeRow>({{root, nodes}}).item) {
    if (fields.key.size() <= at(id)) fields.key.resize(at(id) + 1);
    fields.key[at(id)] = key;
  }
  return fields;
}

/// What the twin says of them.
Fields fields_of(const test::ReferenceLevel0& level0) {
  Fields fields;
  for (const int row : level0.row) fields.row.push_back(row < 0 ? -1 : level0.map->cells()[at(row)].row);
  for (const auto& key : level0.key) {
    auto& written = fields.key.emplace_back();
    if (key.size() > 4) continue;
    std::size_t i = 0;
    for (const auto& [node, weight] : key) {
      written.node[i] = node;
      written.weight[i++] = static_cast<std::int64_t>(weight * 0x1p62);
    }
  }
  return fields;
}

/// What has been compared; a comparison of nothing proves nothing.
struct Tally {
  std::int64_t maps = 0, levels = 0, mapped_cells = 0, rebuilt = 0, kept = 0, early = 0;

  void add(const test::ReferenceRefinement& expected) {
    ++levels;
    mapped_cells += std::count_if(expected.level0.row.begin(), expected.level0.row.end(), [](int r) { return r >= 0; });
    rebuilt += expected.families_rebuilt;
    kept += expected.families_kept;
    early += expected.early_passes;
  }

  /// Collective: sums over the ranks, and tells them once.
  void finish(const par::Comm& comm) {
    for (auto* count : {&maps, &levels, &mapped_cells, &rebuilt, &kept, &early}) *count = comm.sum(*count);
    if (comm.is_first())
      std::printf(
          "compared %ld maps, %ld refinements, %ld cells that descend from bent ones; families: %ld rebuilt, %ld kept; "
          "early passes: %ld\n",
          maps, levels, mapped_cells, rebuilt, kept, early);
  }
};

/// The twin of a mesh on the rank that compares.
struct Twin {
  std::unique_ptr<test::ReferenceMap> map;
  test::ReferenceLevel0 level0;
};

/// Refines once and compares on rank `root`. False when the twin does not follow: there is no map, or a node would have
/// to back off. Collective.
bool compare_level(const par::Comm& comm, mesh::DistMesh& mesh, Twin& twin, std::uint64_t seed, int level, Rank root,
                   Tally& tally) {
  const auto law = test::law_of(seed / 4 + static_cast<std::uint64_t>(level));
  const auto draw = combine(seed, static_cast<std::uint64_t>(level));
  const auto options = options_of(seed);
  const auto whole = test::gather_on(comm, mesh, root);
  const auto flags = test::mark(mesh, law, draw);
  auto fine =
      seed % 2 == 0 ? adapt::refine(comm, mesh, flags, options) : adapt::refine(comm, std::move(mesh), flags, options);
  mesh = std::move(fine.mesh);
  if (mesh.info.level0 == nullptr) return fine.report.cells_out == fine.report.cells_in;  // nothing was marked
  const auto rows = rows_on(comm, *mesh.info.level0, root);
  const auto found = test::gather_on(comm, mesh, root);
  const auto found_fields = fields_on(comm, mesh, root);
  bool goes_on = mesh.info.n_global_cells < enough_cells;
  if (comm.rank() == root) {
    if (twin.map == nullptr) {
      expect_same_map(rows, test::reference_rows(whole, surfaces_of_patches(mesh.info)));
      twin.map = std::make_unique<test::ReferenceMap>(rows, surfaces_of_patches(mesh.info));
      twin.level0 = test::look_at_level0(whole, *twin.map);
      ++tally.maps;
    }
    const auto expected = test::reference_refine(whole, test::mark(whole, law, draw), options.quality_control,
                                                 options.shape_floor, surfaces_of_patches(mesh.info), twin.level0);
    goes_on = goes_on && expected.is_positive;
    if (expected.is_positive) {
      test::expect_same(found, expected);
      test::expect_same_counts(fine.report, expected);
      const auto fields = fields_of(expected.level0);
      test::expect_same_rows(found_fields.row, fields.row, "row of cell");
      test::expect_same_rows(found_fields.key, fields.key, "key of node");
      tally.add(expected);
    }
    twin.level0 = expected.level0;
  }
  return comm.all(goes_on && !testing::Test::HasFailure());
}

bool is_positive(const mesh::DistMesh& mesh) {
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    if (!geometry::is_positive(p[0], p[1], p[2], p[3])) return false;
  }
  return true;
}

Tally compare(const par::Comm& comm, std::uint64_t first, std::uint64_t n_cases) {
  Tally tally;
  for (std::uint64_t seed = first; seed < first + n_cases; ++seed) {
    const auto root = static_cast<Rank>(seed % static_cast<std::uint64_t>(comm.size()));
    auto block = start_of(comm, seed);
    const auto destination = test::random_destinations(comm, block, seed);
    auto mesh = assemble::assemble(comm, std::move(block), destination);
    if (!comm.all(is_positive(mesh))) continue;
    Twin twin;
    for (int level = 0; level < n_levels; ++level) {
      SCOPED_TRACE("mesh " + std::to_string(seed) + ", level " + std::to_string(level));
      if (!compare_level(comm, mesh, twin, seed, level, root, tally)) break;
    }
    if (comm.any(testing::Test::HasFailure())) break;
  }
  tally.finish(comm);
  return tally;
}

TEST(Twin, AgreesNearCoarseCurvedWalls) {
  const par::Comm world(MPI_COMM_WORLD);

  // seeds of their own for each number of ranks: in the full level a thousand on 1 to 4
  const auto tally = compare(world, 1000 * static_cast<std::uint64_t>(world.size()),
                             test::n_cases_on(world, world.size() == 1 ? 8 : 4, 1000));

  EXPECT_GT(tally.maps, 0);
  EXPECT_GT(tally.levels, tally.maps);
  EXPECT_GT(tally.mapped_cells, 0);
}

/// A family whose old middles lie in the middle of their edges while the map puts new ones elsewhere.
TEST(Twin, AgreesWhereOldMiddlesAreStraightAndNewOnesAreNot) {
  const auto tally = compare(par::Comm(MPI_COMM_WORLD), 2161, 1);

  EXPECT_EQ(tally.levels, 3);
}

}  // namespace coarse_walls_twin_test
}  // namespace pamr
