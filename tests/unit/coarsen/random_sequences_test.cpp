// SPDX-License-Identifier: GPL-3.0-or-later
// Random sequences of refining and coarsening: what every mesh of them obeys, and that it depends on the splits that
// remain alone.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <set>

#include "coarsen_case.hpp"
#include "pamr/adapt/forecast.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/validate/validate.hpp"
#include "support/delaunay.hpp"
#include "support/dice.hpp"
#include "support/places.hpp"
#include "support/reference.hpp"
#include "support/reference_family.hpp"

namespace pamr {
namespace random_sequences_test {

using geometry::Vec3;

/// By coordinates only: cells of a ball may be coarsened, cells cut by another are split.
std::vector<std::int8_t> random_flags(const mesh::DistMesh& mesh, std::uint64_t seed) {
  test::Dice dice(mix(seed));
  const Vec3 center{dice.unit(), dice.unit(), dice.unit()};
  const double radius = 0.2 + 0.8 * dice.unit();
  const bool all_go = dice.below(4) == 0;
  const auto split = test::mark(mesh, test::law_of(seed), combine(seed, 1));
  const bool some_split = mesh.info.n_global_cells < 2000 && dice.below(3) != 0;
  std::vector<std::int8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    const auto centroid = 0.25 * (p[0] + p[1] + p[2] + p[3]);
    const bool goes = all_go || norm(centroid - center) < radius;
    flags.push_back(static_cast<std::int8_t>(some_split && split[at(c)] != 0 ? 1 : goes ? -1 : 0));
  }
  return flags;
}

/// The deepest level that there is, and that flags ask for.
int deepest_level(const mesh::DistMesh& mesh, const std::vector<std::int8_t>& flags) {
  int deepest = 0;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    deepest = std::max(deepest, mesh.lineage[at(c)].level() + (flags[at(c)] > 0 ? 1 : 0));
  return deepest;
}

/// The mesh of level 0 with the regular splits of another mesh, asked for until all are there.
mesh::DistMesh with_splits_of(const par::Comm& self, const mesh::BlockMesh& start, const mesh::BlockMesh& other,
                              const refine::Options& options) {
  const auto base = test::places_of_base_cells(other);
  const test::Places reached(base.begin(), base.end());
  auto mesh = test::scatter(self, start, 0);
  for (;;) {
    std::vector<std::uint8_t> flags;
    for (const auto& place : test::places_of_base_cells(test::gather_on(self, mesh, 0)))
      flags.push_back(reached.count(place) == 0 ? 1 : 0);
    if (std::count(flags.begin(), flags.end(), 1) == 0) return mesh;
    mesh = adapt::refine(self, mesh, flags, options).mesh;
    EXPECT_LE(mesh.n_cells(), std::ssize(other.cell_to_node)) << "more is split than remained";
    if (mesh.n_cells() > std::ssize(other.cell_to_node)) return mesh;
  }
}

constexpr std::array<double, 4> floors{0.3, 0, 0.5, 0.35};

TEST(RandomSequences, LeaveTheClosureOfTheSplitsThatRemain) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  std::int64_t n_gone = 0, n_needed = 0, n_closed = 0;
  for (const auto i : test::seeds_alone(world)) {
    const auto start = test::random_delaunay(i);
    const double volume = test::reference_volume(start);
    const adapt::Options options{{.shape_floor = floors[i % 4], .parent_field = false}, {}};
    auto mesh = test::scatter(self, start, 0);
    for (std::uint64_t step = 0; step < 12; ++step) {
      SCOPED_TRACE("mesh " + std::to_string(i) + ", step " + std::to_string(step));
      const auto flags = random_flags(mesh, combine(i, step));
      const int deepest_asked = deepest_level(mesh, flags);
      auto result = adapt::adapt(self, mesh, flags, options);
      mesh = std::move(result.mesh);
      ASSERT_LE(deepest_level(mesh, std::vector<std::int8_t>(at(mesh.n_cells()), 0)), deepest_asked)
          << "closing adds no deeper cells";
      const auto whole = test::gather_on(self, mesh, 0);
      for (const auto& violation : validate::validate(self, mesh)) FAIL() << violation.invariant;
      ASSERT_NEAR(test::reference_volume(whole), volume, 1e-12 * volume);
      ASSERT_EQ(result.coarsening.octets_kept, 0);
      n_gone += result.coarsening.octets_gone;
      n_needed += result.coarsening.octets_needed;
      n_closed += result.coarsening.families_closed;
      if (step % 4 != 3 && !test::is_full_level()) continue;
      const auto expected = with_splits_of(self, start, whole, options.refinement);
      ASSERT_EQ(test::reference_fingerprint(whole), test::reference_fingerprint(test::gather_on(self, expected, 0)));
    }
  }
  EXPECT_GT(world.sum(n_gone), 100);
  EXPECT_GT(world.sum(n_needed), 0);
  EXPECT_GT(world.sum(n_closed), 10);
}

/// Nodes were moved far, families had to be kept and were split: what is coarsened there is tested cell by cell. In
/// mesh 7 nodes that go back would invert a family whose cells are positive where the map puts them.
TEST(RandomSequences, LeaveValidMeshesAtWallsThatAreFarTooCoarse) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  if (world.size() != 1) return;  // all ranks would do the same; the next test has such meshes on all of them
  std::int64_t n_gone = 0, n_kept = 0, n_broken = 0;
  for (std::uint64_t i = 0; i < test::n_cases(8, 60); ++i) {
    adapt::Options options;
    options.refinement.parent_field = false;
    auto mesh = assemble::assemble(self, test::bulging_cube(self, i, 0.15 + 0.05 * static_cast<double>(i % 4)));
    for (std::uint64_t step = 0; step < 12; ++step) {
      SCOPED_TRACE("mesh " + std::to_string(i) + ", step " + std::to_string(step));
      auto flags = random_flags(mesh, combine(i, step));
      if (step < 2) flags = test::with_sign(test::near_dome(mesh, 0.3));
      auto result = adapt::adapt(self, mesh, flags, options);
      mesh = std::move(result.mesh);
      for (const auto& violation : validate::validate(self, mesh)) FAIL() << violation.invariant;
      n_gone += result.coarsening.octets_gone;
      n_kept += result.coarsening.octets_kept + result.coarsening.families_kept;
      n_broken += result.report.closure.families_kept;
    }
  }
  EXPECT_GT(n_gone, 100);
  EXPECT_GT(n_kept, 0);
  EXPECT_GT(n_broken, 0);
}

/// Five calls on mesh `i`, its cells on random ranks before each, beside a forecast and the same on one rank. `n_moved`
/// grows by the cells that moved to their siblings.
void compare_on_all_ranks(const par::Comm& world, std::uint64_t i, std::int64_t& n_moved) {
  const par::Comm self(MPI_COMM_SELF);
  const auto start = i % 2 == 0 ? test::random_delaunay(1000 + i)
                                : test::gather(self, test::bulging_cube(self, i, i % 4 == 1 ? 0.1 : 0.2));
  const adapt::Options options{{.shape_floor = floors[i % 4], .parent_field = true}, {}};
  auto serial = test::scatter(self, start, 0);
  for (std::uint64_t step = 0; step < 5; ++step) {
    SCOPED_TRACE("mesh " + std::to_string(i) + ", step " + std::to_string(step));
    const auto spread = test::scatter(world, test::gather(self, serial), combine(i, step));
    const auto flags = random_flags(spread, combine(i, step));
    const adapt::Forecaster forecaster(world, spread, options.refinement);
    const auto forecast = forecaster.forecast(flags);
    const auto a = adapt::adapt(world, spread, flags, options);
    auto b = adapt::adapt(self, serial, random_flags(serial, combine(i, step)), options);

    ASSERT_EQ(forecast.cells, a.report.cells_out);
    ASSERT_EQ(forecaster.nodes(forecast), a.report.nodes_out);
    EXPECT_EQ(forecast.coarsening.octets_gone, a.coarsening.octets_gone);
    EXPECT_EQ(forecast.coarsening.cells_moved, a.coarsening.cells_moved);
    EXPECT_EQ(forecast.coarsening.cells_between, a.coarsening.cells_between);
    EXPECT_EQ(forecast.marked_too_deep, a.report.marked_too_deep);
    ASSERT_TRUE(validate::validate(world, a.mesh).empty());
    const auto all = test::gather(world, a.mesh), here = test::gather(self, b.mesh);
    ASSERT_TRUE(test::bytes_of(all) == test::bytes_of(here));
    ASSERT_EQ(all.cell_fields.front().integer(), here.cell_fields.front().integer()) << "parent";
    EXPECT_EQ(a.coarsening.octets_gone, b.coarsening.octets_gone);
    EXPECT_EQ(a.coarsening.octets_needed, b.coarsening.octets_needed);
    EXPECT_EQ(a.coarsening.octets_kept, b.coarsening.octets_kept);
    EXPECT_EQ(a.coarsening.families_kept, b.coarsening.families_kept);
    EXPECT_EQ(a.coarsening.cells_without_siblings, b.coarsening.cells_without_siblings);
    n_moved += a.coarsening.cells_moved;
    serial = std::move(b.mesh);
  }
}

TEST(RandomSequences, GiveTheSameBytesOnAnyRanks) {
  const par::Comm world(MPI_COMM_WORLD);
  const auto size = static_cast<std::uint64_t>(world.size());
  // full: 200 meshes on 2, 3 and 4 ranks between them, fewer where ranks wait for each other
  const bool is_shared = test::is_full_level() && size >= 2 && size <= 4;
  const std::array<std::uint64_t, 4> ends{0, 110, 170, 200};
  const std::uint64_t first = is_shared ? ends[size - 2] : 0;
  const std::uint64_t n = is_shared   ? ends[size - 1] - first
                          : size == 1 ? test::n_cases(10, 40)
                                      : test::n_cases_together(world) / 5;
  std::int64_t n_moved = 0;
  for (std::uint64_t i = first; i < first + n && !HasFatalFailure(); ++i) compare_on_all_ranks(world, i, n_moved);
  if (world.size() > 1) {
    EXPECT_GT(n_moved, 0);
  }
}

/// Where one octet has to be kept, what is around it must be looked at by what all ranks knew before. These meshes
/// differed on 2, 3 and 4 ranks.
TEST(RandomSequences, GiveTheSameBytesWhereNeighborsOfKeptOctetsAreInverted) {
  const par::Comm world(MPI_COMM_WORLD);
  if (world.size() > 4 && !test::is_full_level()) return;
  std::int64_t n_moved = 0;
  for (const std::uint64_t i : {23, 51}) compare_on_all_ranks(world, i, n_moved);
}

}  // namespace random_sequences_test
}  // namespace pamr
