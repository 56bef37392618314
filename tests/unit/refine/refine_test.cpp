// SPDX-License-Identifier: GPL-3.0-or-later
// Properties of a whole refinement, on random meshes, random marks and random distributions over the ranks.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/forecast.hpp"
#include "pamr/assemble/kuhn_cube.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/validate/validate.hpp"
#include "support/meshes.hpp"
#include "support/reference.hpp"

namespace pamr {
namespace refine_test {

using refine::QualityControl;

constexpr std::array<QualityControl, 4> all_policies{QualityControl::none, QualityControl::isotropic,
                                                     QualityControl::short_edge, QualityControl::removable};

/// Marks that do not depend on the distribution.
enum class Law { random, sphere, corner };

std::vector<std::uint8_t> mark(const mesh::DistMesh& mesh, Law law, std::uint64_t seed) {
  std::vector<std::uint8_t> flags(static_cast<std::size_t>(mesh.n_cells()));
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    const auto x = 0.25 * (p[0] + p[1] + p[2] + p[3]);
    bool flag = false;
    if (law == Law::random)
      flag = combine(seed, static_cast<std::uint64_t>(mesh.cell_global[static_cast<std::size_t>(c)])) % 20 == 0;
    if (law == Law::sphere) {
      double least = 1e300, greatest = 0;
      for (const auto q : p) {
        const double d = geometry::norm(q - geometry::Vec3{0.5, 0.5, 0.5});
        least = std::min(least, d);
        greatest = std::max(greatest, d);
      }
      flag = least < 0.35 && 0.35 < greatest;
    }
    if (law == Law::corner) flag = geometry::norm(x) < 0.3;
    flags[static_cast<std::size_t>(c)] = flag ? 1 : 0;
  }
  return flags;
}

struct Run {
  mesh::DistMesh mesh;
  std::vector<adapt::Report> reports;
};

Run refine_levels(const par::Comm& comm, mesh::DistMesh mesh, Law law, QualityControl policy, int n_levels) {
  Run run{std::move(mesh), {}};
  for (int level = 0; level < n_levels; ++level) {
    const auto flags = mark(run.mesh, law, static_cast<std::uint64_t>(17 + level));
    auto result = adapt::refine(comm, run.mesh, flags, {.quality_control = policy, .marks_field = ""});
    run.mesh = std::move(result.mesh);
    run.reports.push_back(result.report);
  }
  return run;
}

void expect_sound(const mesh::BlockMesh& whole, double volume) {
  // conforming: the neighbors by table are those that a map of all faces gives
  const auto reference = test::reference_neighbors(whole.cell_to_node);
  ASSERT_EQ(reference.size(), whole.cell_to_cell.size());
  for (std::size_t c = 0; c < reference.size(); ++c)
    for (std::size_t f = 0; f < 4; ++f)
      ASSERT_EQ(std::max<GlobalId>(whole.cell_to_cell[c][f], -1), reference[c][f]) << "cell " << c << " face " << f;
  for (const auto& n : whole.cell_to_node) {
    std::array<geometry::Vec3, 4> p{};
    for (std::size_t i = 0; i < 4; ++i) p[i] = whole.node_position[static_cast<std::size_t>(n[i])];
    ASSERT_GT(geometry::orientation(p[0], p[1], p[2], p[3]), 0);
  }
  EXPECT_NEAR(test::reference_volume(whole), volume, 1e-12 * volume);
}

void expect_equal(const mesh::BlockMesh& a, const mesh::BlockMesh& b) {
  EXPECT_TRUE(a.node_position == b.node_position);
  EXPECT_TRUE(a.cell_to_node == b.cell_to_node);
  EXPECT_TRUE(a.cell_to_cell == b.cell_to_cell);
  EXPECT_TRUE(a.lineage == b.lineage);
  ASSERT_EQ(a.cell_fields.size(), b.cell_fields.size());
  for (std::size_t i = 0; i < a.cell_fields.size(); ++i) EXPECT_TRUE(a.cell_fields[i].value == b.cell_fields[i].value);
}

class EveryPolicy : public ::testing::TestWithParam<QualityControl> {};
INSTANTIATE_TEST_SUITE_P(Refine, EveryPolicy, ::testing::ValuesIn(all_policies));

TEST_P(EveryPolicy, GivesASoundMeshEqualToTheSerialOneForAnyDistribution) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  for (const auto law : {Law::random, Law::sphere, Law::corner})
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      const auto block = test::random_mesh(comm, seed, 3);
      const auto destination = test::random_destinations(comm, block, seed);
      const auto whole = test::gather(comm, block);
      const double volume = test::reference_volume(whole);

      const auto spread = refine_levels(comm, assemble::assemble(comm, block, destination), law, GetParam(), 3);
      const auto serial = refine_levels(self, assemble::assemble(self, test::cut(self, whole)), law, GetParam(), 3);

      const auto result = test::gather(comm, spread.mesh);
      expect_sound(result, volume);
      expect_equal(result, test::gather(self, serial.mesh));
      for (const auto& report : spread.reports) EXPECT_EQ(report.marked_not_split, 0);
      const auto areas = test::reference_patch_areas(result), before = test::reference_patch_areas(whole);
      ASSERT_EQ(areas.size(), before.size());
      for (std::size_t p = 0; p < areas.size(); ++p) EXPECT_NEAR(areas[p], before[p], 1e-12);
    }
}

TEST_P(EveryPolicy, PassesValidationAfterEachLevel) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 4));
  for (int level = 0; level < 3; ++level) {
    mesh =
        adapt::refine(comm, mesh, mark(mesh, Law::sphere, 0), {.quality_control = GetParam(), .marks_field = ""}).mesh;
    for (const auto& violation : validate::validate(comm, mesh))
      ADD_FAILURE() << violation.invariant << " " << violation.count << " at " << violation.where;
  }
}

TEST_P(EveryPolicy, LeavesAMeshWithoutMarksAsItIs) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto block = test::random_mesh(comm, 5, 3);
  const auto once = refine_levels(comm, assemble::assemble(comm, block), Law::corner, GetParam(), 1).mesh;

  const std::vector<std::uint8_t> nothing(static_cast<std::size_t>(once.n_cells()), 0);
  auto same =
      adapt::refine(comm, once, nothing, {.quality_control = GetParam(), .parent_field = false, .marks_field = ""})
          .mesh;

  auto before = test::gather(comm, once), after = test::gather(comm, same);
  before.cell_fields.clear();
  after.cell_fields.clear();
  expect_equal(before, after);
}

TEST_P(EveryPolicy, MakesEightToTheKCellsWhenAllAreMarkedKTimes) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, test::random_mesh(comm, 9, 2));
  for (std::int64_t expected = 48 * 8; expected <= 48 * 64; expected *= 8) {
    const std::vector<std::uint8_t> all(static_cast<std::size_t>(mesh.n_cells()), 1);
    mesh = adapt::refine(comm, mesh, all, {.quality_control = GetParam(), .marks_field = ""}).mesh;
    EXPECT_EQ(mesh.info.n_global_cells, expected);
  }
  expect_sound(test::gather(comm, mesh), 1.0);
}

TEST_P(EveryPolicy, PredictsItsSizeExactly) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, test::random_mesh(comm, 4, 3));
  for (int level = 0; level < 3; ++level) {
    const auto flags = mark(mesh, Law::random, 3);
    const refine::Options options{.quality_control = GetParam(), .marks_field = ""};
    const adapt::Forecaster forecaster(comm, mesh, options);
    const auto forecast = forecaster.forecast(flags);
    const auto result = adapt::refine(comm, mesh, flags, options);
    EXPECT_EQ(forecast.cells, result.report.cells_out);
    EXPECT_EQ(forecaster.nodes(forecast), result.report.nodes_out);
    EXPECT_EQ(forecast.cells_on_this_rank, result.mesh.n_cells());
    mesh = result.mesh;
  }
}

TEST(Removable, KeepsTheShapesBoundedWhereNoControlDoesNot) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto worst = [&](QualityControl policy) {
    const auto run =
        refine_levels(comm, assemble::assemble(comm, assemble::kuhn_cube(comm, 4)), Law::sphere, policy, 4);
    double here = 1;
    for (LocalId c = 0; c < run.mesh.n_cells(); ++c) here = std::min(here, geometry::mean_ratio(run.mesh.points(c)));
    return comm.min(here);
  };
  const double removable = worst(QualityControl::removable);
  EXPECT_GT(removable, 2 * worst(QualityControl::none));
  EXPECT_GT(removable, 0.3);
}

TEST(Removable, NeverSplitsAClosureCell) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto run = refine_levels(comm, assemble::assemble(comm, test::random_mesh(comm, 6, 3)), Law::random,
                                 QualityControl::removable, 4);
  for (const auto lineage : run.mesh.lineage) EXPECT_FALSE(lineage.is_broken());
  EXPECT_GT(run.reports.back().closure.families_rebuilt, 0);
}

TEST(Removable, GivesTheSameWhetherCutFacesAreKnownToConformOrNot) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto refine = [&comm](const mesh::DistMesh& before, QualityControl policy, GlobalId step = 11) {
    std::vector<std::uint8_t> flags;
    for (const auto cell : before.cell_global) flags.push_back(cell % step == 0 ? 1 : 0);
    return adapt::refine(comm, before, flags, {.quality_control = policy, .marks_field = ""}).mesh;
  };
  const auto known = refine(assemble::assemble(comm, test::random_mesh(comm, 4, 3)), QualityControl::removable);
  ASSERT_TRUE(known.info.cut_faces_conform);
  auto unknown = known;
  unknown.info.cut_faces_conform = false;

  const auto fine = refine(known, QualityControl::removable);
  EXPECT_TRUE(fine.info.cut_faces_conform);
  EXPECT_EQ(mesh::fingerprint(comm, fine), mesh::fingerprint(comm, refine(unknown, QualityControl::removable)));
  const auto mixed = refine(known, QualityControl::none, 101);
  EXPECT_FALSE(mixed.info.cut_faces_conform);
  EXPECT_FALSE(refine(mixed, QualityControl::removable).info.cut_faces_conform) << "families were kept";
}

/// Three levels of a Kuhn cube with a high floor: marks in children of red families imply others on edges that are new.
struct EarlyCase {
  mesh::DistMesh before;
  std::vector<std::uint8_t> flags;
  refine::Options options{.shape_floor = 0.68, .marks_field = ""};
};

EarlyCase make_early_case(const par::Comm& comm) {
  EarlyCase early{assemble::assemble(comm, assemble::kuhn_cube(comm, 4)), {}};
  for (int level = 0; level < 2; ++level)
    early.before = adapt::refine(comm, early.before, mark(early.before, Law::sphere, 0), early.options).mesh;
  early.flags = mark(early.before, Law::sphere, 0);
  return early;
}

TEST(EarlySplits, AreForecastAndLeaveAClosedMeshOverTheFloor) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto early = make_early_case(comm);
  const adapt::Forecaster forecaster(comm, early.before, early.options);
  const auto forecast = forecaster.forecast(early.flags);

  const auto result = adapt::refine(comm, early.before, early.flags, early.options);

  EXPECT_GT(result.report.closure.early_passes, 0);
  EXPECT_EQ(result.report.marked_not_split, 0);
  EXPECT_EQ(result.report.cells_in, early.before.info.n_global_cells);
  EXPECT_EQ(forecast.cells, result.report.cells_out);
  EXPECT_EQ(forecaster.nodes(forecast), result.report.nodes_out);
  std::int64_t children = 0;
  for (const auto n : forecast.children) children += n;
  EXPECT_EQ(children, result.mesh.n_cells());
  for (LocalId c = 0; c < result.mesh.n_cells(); ++c)
    ASSERT_GE(geometry::mean_ratio(result.mesh.points(c)), 0.68 * (1 - 1e-12));
  const auto whole = test::gather(comm, result.mesh);
  expect_sound(whole, 1.0);
  for (const auto& field : whole.cell_fields)
    for (const auto parent : field.integer()) {
      ASSERT_EQ(field.name, mesh::parent_field);
      ASSERT_TRUE(parent >= 0 && parent < early.before.info.n_global_cells);
    }
  const std::vector<std::uint8_t> nothing(static_cast<std::size_t>(result.mesh.n_cells()), 0);
  const auto again = adapt::refine(comm, result.mesh, nothing, early.options);
  EXPECT_EQ(mesh::fingerprint(comm, again.mesh), mesh::fingerprint(comm, result.mesh));
}

TEST(EarlySplits, AreTheSameWithCellsThatMoveAndOnOneRank) {
  const par::Comm comm(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  const auto early = make_early_case(comm), alone = make_early_case(self);
  const auto here = adapt::refine(comm, early.before, early.flags, early.options);
  const auto serial = adapt::refine(self, alone.before, alone.flags, alone.options);

  auto moving = early.before;
  const auto moved =
      adapt::refine(comm, std::move(moving), early.flags, early.options, adapt::balancing_named("blocks", "exact"));

  expect_equal(test::gather(comm, here.mesh), test::gather(comm, moved.mesh));
  EXPECT_EQ(mesh::fingerprint(comm, here.mesh), mesh::fingerprint(self, serial.mesh));
  EXPECT_EQ(here.report.closure.early_passes, serial.report.closure.early_passes);
  EXPECT_EQ(here.report.closure.families_rebuilt, serial.report.closure.families_rebuilt);
}

TEST(Refine, RefusesAShapeFloorThatIsNoMeanRatio) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 2));
  const std::vector<std::uint8_t> flags(static_cast<std::size_t>(mesh.n_cells()), 0);
  for (const double floor : {-0.1, 1.1, std::nan("")}) {
    EXPECT_THROW(adapt::refine(comm, mesh, flags, {.shape_floor = floor, .marks_field = {}}), Error);
    EXPECT_THROW(adapt::Forecaster(comm, mesh, {.shape_floor = floor, .marks_field = {}}).forecast(flags), Error);
  }
}

TEST(Refine, RefusesFlagsOfTheWrongLengthOnEveryRank) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = assemble::assemble(comm, assemble::kuhn_cube(comm, 2));
  const std::vector<std::uint8_t> flags(static_cast<std::size_t>(mesh.n_cells()) + (comm.is_first() ? 1 : 0), 0);
  EXPECT_THROW(adapt::refine(comm, mesh, flags), Error);
}

}  // namespace refine_test
}  // namespace pamr
