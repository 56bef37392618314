// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/quality_report.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <numeric>

#include "pamr/assemble/assemble.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/check/extract.hpp"
#include "support/meshes.hpp"

namespace pamr::check {
namespace quality_report_test {

using geometry::Vec3;

/// A displacement of inner and boundary nodes that depends on the position alone; small enough to invert no cell.
Vec3 shaken(Vec3 p, double size) {
  const auto random = [&](std::uint64_t seed) {
    const auto bits = combine(combine(combine(seed, bits_of(p.x)), bits_of(p.y)), bits_of(p.z));
    return size * (std::ldexp(static_cast<double>(bits >> 11U), -52) - 1.0);
  };
  return {p.x + random(1), p.y + random(2), p.z + random(3)};
}

/// The Kuhn cube with moved nodes, its cells scattered over the ranks without any order.
mesh::DistMesh shaken_cube(const par::Comm& comm, int n, double size) {
  auto block = assemble::kuhn_cube(comm, n);
  for (auto& p : block.node_position) p = shaken(p, size);
  std::vector<Rank> destination;
  for (std::size_t i = 0; i < block.cell_to_node.size(); ++i) {
    const auto id = static_cast<std::uint64_t>(block.first_cell) + i;
    destination.push_back(static_cast<Rank>(mix(id) % static_cast<std::uint64_t>(comm.size())));
  }
  return assemble::assemble(comm, std::move(block), destination);
}

QualityReport report_of(const par::Comm& comm, const mesh::DistMesh& mesh) { return report_quality(comm, mesh); }

std::uint64_t bits(double value) { return std::bit_cast<std::uint64_t>(value); }

void expect_same_bits(const QualityReport& a, const QualityReport& b) {
  EXPECT_EQ(a.cells, b.cells);
  EXPECT_EQ(a.nodes, b.nodes);
  EXPECT_EQ(bits(a.volume), bits(b.volume));
  EXPECT_EQ(bits(a.bounding_box_diagonal), bits(b.bounding_box_diagonal));
  ASSERT_EQ(a.patches.size(), b.patches.size());
  for (std::size_t i = 0; i < a.patches.size(); ++i) {
    EXPECT_EQ(a.patches[i].name, b.patches[i].name);
    EXPECT_EQ(a.patches[i].faces, b.patches[i].faces);
    EXPECT_EQ(bits(a.patches[i].area), bits(b.patches[i].area));
    EXPECT_EQ(bits(a.patches[i].worst_distance), bits(b.patches[i].worst_distance));
    EXPECT_EQ(a.patches[i].off_surface_nodes, b.patches[i].off_surface_nodes);
    EXPECT_EQ(bits(a.patches[i].mean_normal_deviation), bits(b.patches[i].mean_normal_deviation));
    EXPECT_EQ(bits(a.patches[i].worst_normal_deviation), bits(b.patches[i].worst_normal_deviation));
  }
  EXPECT_EQ(a.inverted_cells, b.inverted_cells);
  EXPECT_EQ(a.conforming, b.conforming);
  EXPECT_EQ(a.neighbors_consistent, b.neighbors_consistent);
  ASSERT_EQ(a.metrics.size(), b.metrics.size());
  for (std::size_t i = 0; i < a.metrics.size(); ++i) {
    EXPECT_EQ(bits(a.metrics[i].min), bits(b.metrics[i].min));
    EXPECT_EQ(bits(a.metrics[i].mean), bits(b.metrics[i].mean));
    EXPECT_EQ(bits(a.metrics[i].max), bits(b.metrics[i].max));
    EXPECT_EQ(a.metrics[i].histogram, b.metrics[i].histogram);
  }
  EXPECT_EQ(a.cells_of_level, b.cells_of_level);
  EXPECT_EQ(a.off_surface.nodes, b.off_surface.nodes);
  EXPECT_EQ(bits(a.off_surface.worst), bits(b.off_surface.worst));
  EXPECT_EQ(a.fingerprint, b.fingerprint);
}

TEST(QualityReport, OfTheKuhnCubeIsWhatCanBeWorkedOutByHand) {
  par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = shaken_cube(comm, 4, 0);

  const auto report = report_of(comm, mesh);

  EXPECT_TRUE(report.is_valid());
  EXPECT_TRUE(report.conforming);
  EXPECT_TRUE(report.neighbors_consistent);
  EXPECT_EQ(report.cells, 6 * 64);
  EXPECT_EQ(report.nodes, 125);
  EXPECT_DOUBLE_EQ(report.volume, 1.0);
  EXPECT_DOUBLE_EQ(report.bounding_box_diagonal, std::sqrt(3.0));
  EXPECT_EQ(report.inverted_cells, 0);
  ASSERT_EQ(report.patches.size(), 6U);
  for (const auto& patch : report.patches) {
    EXPECT_EQ(patch.faces, 32);
    EXPECT_DOUBLE_EQ(patch.area, 1.0);
    EXPECT_EQ(patch.worst_distance, 0.0);
    EXPECT_EQ(patch.off_surface_nodes, 0);
  }
  EXPECT_EQ(report.cells_of_level, std::vector<std::int64_t>{6 * 64});
  EXPECT_EQ(report.closure_cells, 0);
  // All cells are congruent: edges 1 1 1 sqrt2 sqrt2 sqrt3 (times 1/4), volume 1/6, dihedral angles 45, 60, 90 degrees.
  for (const auto& metric : report.metrics) {
    EXPECT_NEAR(metric.min, metric.max, 1e-12 * metric.max) << metric.name;
    EXPECT_EQ(std::accumulate(metric.histogram.begin(), metric.histogram.end(), std::int64_t{0}), 6 * 64);
  }
  EXPECT_NEAR(report.metrics[1].mean, 12.0 * std::pow(0.5, 2.0 / 3.0) / 10.0, 1e-12);
  EXPECT_NEAR(report.metrics[3].mean, 45.0, 1e-9);
  EXPECT_NEAR(report.metrics[4].mean, 90.0, 1e-9);
  EXPECT_NEAR(report.metrics[5].mean, std::sqrt(3.0), 1e-12);
}

TEST(QualityReport, HasTheSameBitsForEveryNumberOfRanks) {
  par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto shared = shaken_cube(world, 4, 0.03), whole = shaken_cube(self, 4, 0.03);

  expect_same_bits(report_of(world, shared), report_of(self, whole));
}

/// The left half of a cube is region 7, without a name, the right one 3, "right".
mesh::DistMesh halves(const par::Comm& comm) {
  auto mesh = shaken_cube(comm, 4, 0.03);
  std::vector<std::int64_t> region;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    region.push_back(0.25 * (p[0] + p[1] + p[2] + p[3]).x < 0.5 ? 7 : 3);
  }
  mesh.cell_fields.push_back({mesh::region_field, "", 1, mesh::StorageType::int64, std::move(region)});
  mesh.info.regions = {{3, "right"}};
  return mesh;
}

TEST(QualityReport, MeasuresRegions) {
  par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);

  const auto report = report_of(world, halves(world)), whole = report_of(self, halves(self));

  ASSERT_EQ(report.regions.size(), 2U);
  const auto &right = report.regions[0], &left = report.regions[1];
  EXPECT_EQ(right.number, 3);
  EXPECT_EQ(right.name, "right");
  EXPECT_EQ(left.number, 7);
  EXPECT_EQ(left.name, "7");
  EXPECT_EQ(right.cells + left.cells, report.cells);
  EXPECT_NEAR(static_cast<double>(right.cells), 192, 12);
  EXPECT_NEAR(right.volume + left.volume, report.volume, 1e-15);
  EXPECT_EQ(std::min(right.min_mean_ratio, left.min_mean_ratio), report.metrics[1].min);
  EXPECT_LT(report.metrics[1].min, std::max(right.min_mean_ratio, left.min_mean_ratio));
  for (std::size_t r = 0; r < 2; ++r) {
    EXPECT_EQ(bits(report.regions[r].volume), bits(whole.regions[r].volume));
    EXPECT_EQ(bits(report.regions[r].min_mean_ratio), bits(whole.regions[r].min_mean_ratio));
  }
}

TEST(QualityReport, TakesAFieldOfManyValuesForNoRegions) {
  par::Comm comm(MPI_COMM_WORLD);
  auto mesh = shaken_cube(comm, 6, 0);
  std::vector<std::int64_t> region(mesh.cell_global.begin(), mesh.cell_global.end());
  mesh.cell_fields.push_back({mesh::region_field, "", 1, mesh::StorageType::int64, std::move(region)});

  EXPECT_TRUE(report_of(comm, mesh).regions.empty());
}

TEST(QualityReport, CountsANodeOffItsSurfaceOnceForEachPatch) {
  par::Comm comm(MPI_COMM_WORLD);
  auto mesh = shaken_cube(comm, 2, 0);
  // The corner (0,0,0) moves by 1/8 off the patches xmin, ymin and zmin; it is on several ranks.
  for (auto& p : mesh.node_position)
    if (p == Vec3{0, 0, 0}) p = {0.125, 0.125, 0.125};

  const auto report = report_of(comm, mesh);

  for (const auto& patch : report.patches) {
    const bool moved = patch.name == "xmin" || patch.name == "ymin" || patch.name == "zmin";
    EXPECT_EQ(patch.off_surface_nodes, moved ? 1 : 0) << patch.name;
    EXPECT_EQ(patch.worst_distance, moved ? 0.125 : 0.0) << patch.name;
  }
}

TEST(QualityReport, CountsInvertedAndFlatCellsExactly) {
  par::Comm comm(MPI_COMM_WORLD);
  auto mesh = shaken_cube(comm, 1, 0);
  for (auto& p : mesh.node_position)
    if (p == Vec3{1, 0, 0}) p = {0, 1, 0};  // falls onto another corner: two cells hold it

  const auto report = report_of(comm, mesh);

  EXPECT_EQ(report.inverted_cells, 2);
  EXPECT_FALSE(report.is_valid());
}

TEST(QualityReport, SurvivesCoordinatesThatAreNotFinite) {
  par::Comm comm(MPI_COMM_WORLD);
  auto mesh = shaken_cube(comm, 1, 0);
  for (auto& p : mesh.node_position)
    if (p == Vec3{1, 0, 0}) p.x = std::nan("");

  const auto report = report_of(comm, mesh);

  EXPECT_EQ(report.inverted_cells, 2);
  EXPECT_FALSE(report.is_valid());
  EXPECT_EQ(report.metrics[1].min, 0.0);
}

TEST(QualityReport, ReadsTheNodesOffTheirSurfaceCountingSharedOnesOnce) {
  par::Comm comm(MPI_COMM_WORLD);
  auto mesh = shaken_cube(comm, 2, 0);
  mesh::Field off_surface;
  off_surface.name = "off_surface";
  for (const auto p : mesh.node_position)
    off_surface.real().push_back(p.x == 0.0 && p.y == 0.5 ? 0.25 * (1 + p.z) : 0.0);
  mesh.node_fields.push_back(off_surface);

  const auto report = report_of(comm, mesh);

  EXPECT_EQ(report.off_surface.nodes, 3);
  EXPECT_EQ(report.off_surface.worst, 0.5);
}

TEST(QualityReport, CountsLevelsAndClosureCells) {
  par::Comm comm(MPI_COMM_WORLD);
  auto mesh = shaken_cube(comm, 1, 0);
  for (std::size_t i = 0; i < mesh.lineage.size(); ++i)
    if (mesh.cell_global[i] < 2)
      mesh.lineage[i] = mesh::Lineage(mesh::FamilyKind::edge, 0, static_cast<int>(mesh.cell_global[i]), 2);

  const auto report = report_of(comm, mesh);

  EXPECT_EQ(report.cells_of_level, (std::vector<std::int64_t>{4, 0, 2}));
  EXPECT_EQ(report.closure_cells, 2);
}

TEST(QualityReport, SeesAHangingNode) {
  // Above the triangle (0,1,2) one cell, below it three that share a node in its middle.
  par::Comm comm(MPI_COMM_WORLD);
  const std::vector<Vec3> nodes{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0.25, 0.25, 0}, {0, 0, 1}, {0, 0, -1}};
  const auto hanging =
      assemble::assemble(comm, test::small_mesh(comm, nodes, {{0, 1, 2, 4}, {1, 0, 3, 5}, {2, 1, 3, 5}, {0, 2, 3, 5}}));
  const auto closed = assemble::assemble(
      comm, test::small_mesh(comm, nodes,
                             {{0, 1, 3, 4}, {1, 2, 3, 4}, {2, 0, 3, 4}, {1, 0, 3, 5}, {2, 1, 3, 5}, {0, 2, 3, 5}}));

  EXPECT_FALSE(report_of(comm, hanging).conforming);
  EXPECT_EQ(report_of(comm, hanging).inverted_cells, 0);
  EXPECT_TRUE(report_of(comm, closed).conforming);
  EXPECT_TRUE(report_of(comm, closed).is_valid());
}

TEST(CellMetrics, AreBestForTheRegularTetrahedron) {
  const geometry::TetPoints regular{Vec3{1, 1, 1}, Vec3{1, -1, -1}, Vec3{-1, 1, -1}, Vec3{-1, -1, 1}};

  const auto value = cell_metrics(regular);

  EXPECT_NEAR(value[0], 1, 1e-14);
  EXPECT_NEAR(std::abs(value[1]), 1, 1e-14);
  EXPECT_NEAR(value[2], 1, 1e-14);
  EXPECT_NEAR(value[3], std::acos(1.0 / 3) * 180 / std::acos(-1.0), 1e-12);
  EXPECT_NEAR(value[4], value[3], 1e-12);
  EXPECT_NEAR(value[5], 1, 1e-14);
}

TEST(WorstCells, AreTheSameForEveryNumberOfRanks) {
  par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto shared = shaken_cube(world, 3, 0.05), whole = shaken_cube(self, 3, 0.05);

  for (const std::int64_t count : {1, 10, 1000}) {
    const auto some = extract_cells(world, shared, worst_cells(world, shared, count));
    const auto twin = extract_cells(self, whole, worst_cells(self, whole, count));

    EXPECT_EQ(some.info.n_global_cells, std::min<std::int64_t>(count, 6 * 27));
    EXPECT_EQ(some.info.n_global_nodes, twin.info.n_global_nodes);
    EXPECT_EQ(measure_cells(world, some)[1].max, measure_cells(self, twin)[1].max);
    const auto& old_cell = some.find_cell_field("cell")->integer();
    const auto& quality = some.find_cell_field("mean_ratio")->real();
    for (std::size_t i = 0; i < old_cell.size(); ++i) {
      const auto twin_at = static_cast<std::size_t>(some.cell_global[i]);
      EXPECT_EQ(old_cell[i], twin.find_cell_field("cell")->integer()[twin_at]);
      EXPECT_EQ(quality[i], geometry::mean_ratio(some.points(static_cast<LocalId>(i))));
    }
  }
}

}  // namespace quality_report_test
}  // namespace pamr::check
