// SPDX-License-Identifier: GPL-3.0-or-later
// The refiner against its slow, obvious twin, bit for bit, on small random meshes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <stdexcept>
#include <string>

#include "expect_same.hpp"
#include "pamr/adapt/adapt.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/geometry/sphere.hpp"
#include "random_case.hpp"
#include "support/delaunay.hpp"
#include "support/meshes.hpp"
#include "support/reference_refine.hpp"

namespace pamr {
namespace twin_test {

using refine::QualityControl;
using test::Law;

constexpr GlobalId enough_cells = 600;  ///< no further level on larger meshes: the twin is slow

/// One random refinement over several levels, planned by its seed.
struct Plan {
  std::uint64_t seed = 0;
  std::vector<QualityControl> policy;  ///< of each level
  bool shaken = false;                 ///< nodes are moved between levels
  bool curved = false;                 ///< new nodes go to a dome

  /// Of all levels but one in eight, which draws another: then closures of another floor are met.
  double shape_floor(std::size_t level) const {
    constexpr std::array<double, 5> floors{0.35, 0, 0.5, 0.68, 1};
    const auto drawn = combine(seed, level) % 8 == 0 ? combine(seed, 100 + level) : mix(seed);
    return floors[static_cast<std::size_t>(drawn % floors.size())];
  }
};

mesh::BlockMesh start_of(const Plan& plan) {
  return plan.curved ? test::random_dome(plan.seed) : test::random_delaunay(plan.seed);
}

std::string describe(const Plan& plan, std::size_t level) {
  std::string text = "mesh " + std::to_string(plan.seed) + (plan.shaken ? ", shaken" : "") + ", level " +
                     std::to_string(level) + ", policies";
  for (const auto policy : plan.policy)
    text += std::string(" ") + refine::quality_control_names[static_cast<std::size_t>(policy)].first;
  return text;
}

/// What the refiner should have made of one level.
struct Expected {
  mesh::BlockMesh input;
  Law law = Law::random;
  std::uint64_t seed = 0;
  QualityControl policy{};
  double shape_floor = 0;
  test::ReferenceRefinement result;

  refine::Options options() const { return {.quality_control = policy, .shape_floor = shape_floor, .marks_field = ""}; }
};

/// All levels of a plan by the twin alone.
std::vector<Expected> run_twin(const Plan& plan) {
  std::vector<Expected> levels;
  auto mesh = start_of(plan);
  const geometry::Sphere dome({0, 0, -4}, 4);
  std::vector<const geometry::Surface*> surface_of_patch;
  if (plan.curved) surface_of_patch = {nullptr, &dome};
  for (std::size_t level = 0; level < plan.policy.size() && mesh.info.n_global_cells < enough_cells; ++level) {
    const auto seed = combine(plan.seed, level);
    if (plan.shaken && level > 0) test::shake(mesh, seed);
    Expected expected{mesh, test::law_of(plan.seed / 6 + level), seed, plan.policy[level], plan.shape_floor(level), {}};
    try {
      const auto flags = test::mark(mesh, expected.law, seed);
      expected.result = test::reference_refine(mesh, flags, expected.policy, expected.shape_floor, surface_of_patch);
    } catch (const std::logic_error& error) {
      throw std::logic_error(describe(plan, level) + ": " + error.what());
    }
    // where nodes are smoothed or back off the twin does not follow
    if (plan.curved && (expected.result.largest_move >= 0.02 || !expected.result.is_positive)) break;
    mesh = expected.result.mesh;
    const bool goes_on = expected.result.is_positive;
    levels.push_back(std::move(expected));
    if (!goes_on) break;
  }
  return levels;
}

/// What has been compared; a comparison of nothing proves nothing.
struct Tally {
  std::int64_t cases = 0, levels = 0, cells = 0, rebuilt = 0, kept = 0, early = 0, refused = 0;

  void add(const Expected& expected) {
    ++levels;
    cells += expected.result.mesh.info.n_global_cells;
    rebuilt += expected.result.families_rebuilt;
    kept += expected.result.families_kept;
    early += expected.result.early_passes;
    refused += expected.result.is_positive ? 0 : 1;
  }

  /// Collective: sums over the ranks, and tells them once.
  void finish(const par::Comm& comm) {
    for (auto* count : {&cases, &levels, &cells, &rebuilt, &kept, &early, &refused}) *count = comm.sum(*count);
    if (comm.is_first())
      std::printf(
          "compared %ld meshes, %ld refinements, %ld cells; families: %ld rebuilt, %ld kept; "
          "early passes: %ld; refused: %ld\n",
          cases, levels, cells, rebuilt, kept, early, refused);
  }
};

/// Refines one level on `comm` and compares on rank `root`, the only one that needs `expected.result`.
void compare_level(const par::Comm& comm, const Expected& expected, Rank root) {
  const auto mesh = test::scatter(comm, expected.input, expected.seed);
  const auto flags = test::mark(mesh, expected.law, expected.seed);
  const bool is_root = comm.rank() == root;
  if (comm.any(is_root && !expected.result.is_positive)) {
    EXPECT_THROW(adapt::refine(comm, mesh, flags, expected.options()), Error);
    return;
  }
  const auto fine = adapt::refine(comm, mesh, flags, expected.options());
  const auto found = test::gather_on(comm, fine.mesh, root);
  if (!is_root) return;
  test::expect_same(found, expected.result);
  test::expect_same_counts(fine.report, expected.result);
}

Plan plan_of(std::uint64_t seed, std::vector<QualityControl> policy) {
  return {seed, std::move(policy), (seed / 7) % 3 == 0, false};
}

std::vector<QualityControl> levels_of(QualityControl policy, std::uint64_t seed) {
  return std::vector<QualityControl>(2 + seed % 3, policy);
}

/// Every rank compares cases of its own, alone.
template <class MakePlan>
Tally compare_alone(MakePlan&& make_plan) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  Tally tally;
  for (const auto i : test::seeds_alone(world)) {
    const Plan plan = make_plan(i);
    const auto levels = run_twin(plan);
    ++tally.cases;
    for (std::size_t level = 0; level < levels.size(); ++level) {
      SCOPED_TRACE(describe(plan, level));
      compare_level(self, levels[level], 0);
      tally.add(levels[level]);
      if (testing::Test::HasFailure()) break;
    }
    if (testing::Test::HasFailure()) break;
  }
  tally.finish(world);
  return tally;
}

/// All ranks refine together; the twin of a case runs on one of them. Each number of ranks has seeds of its own: in the
/// full level 1 to 4 ranks go through a thousand cases between them.
template <class MakePlan>
Tally compare_together(MakePlan&& plan_of_seed) {
  const par::Comm world(MPI_COMM_WORLD);
  Tally tally;
  const auto size = static_cast<std::uint64_t>(world.size());
  const auto n_cases = test::n_cases_on(world, 5, 1000);
  const auto make_plan = [&](std::uint64_t i) { return plan_of_seed(1000 * (size - 1) + i); };
  for (std::uint64_t begin = 0; begin < n_cases; begin += size) {
    const auto mine = begin + static_cast<std::uint64_t>(world.rank());
    const auto levels_here = mine < n_cases ? run_twin(make_plan(mine)) : std::vector<Expected>{};
    for (Rank root = 0; root < world.size() && begin + static_cast<std::uint64_t>(root) < n_cases; ++root) {
      const bool is_root = root == world.rank();
      if (is_root) ++tally.cases;
      const auto n_levels =
          static_cast<std::size_t>(world.max(is_root ? static_cast<std::int64_t>(levels_here.size()) : 0));
      const Plan plan = make_plan(begin + static_cast<std::uint64_t>(root));
      for (std::size_t level = 0; level < n_levels; ++level) {
        SCOPED_TRACE(describe(plan, level));
        Expected expected;
        if (is_root) {
          expected = levels_here[level];
          tally.add(expected);
        }
        expected.input = test::broadcast(world, expected.input, root);
        const auto start = start_of(plan);
        expected.input.info.patches = start.info.patches;
        expected.input.info.surfaces = start.info.surfaces;
        expected.law = test::law_of(plan.seed / 6 + level);
        expected.seed = combine(plan.seed, level);
        expected.policy = plan.policy[level];
        expected.shape_floor = plan.shape_floor(level);
        compare_level(world, expected, root);
        if (world.any(testing::Test::HasFailure())) return tally;
      }
    }
  }
  tally.finish(world);
  return tally;
}

class TwinOf : public ::testing::TestWithParam<QualityControl> {};
INSTANTIATE_TEST_SUITE_P(Policy, TwinOf,
                         ::testing::Values(QualityControl::none, QualityControl::isotropic, QualityControl::short_edge,
                                           QualityControl::removable),
                         [](const auto& policy) {
                           std::string name =
                               refine::quality_control_names[static_cast<std::size_t>(policy.param)].first;
                           std::replace(name.begin(), name.end(), '-', '_');
                           return name;
                         });

TEST_P(TwinOf, AgreesOnRandomMeshesRefinedByEachRankAlone) {
  const auto tally = compare_alone([](std::uint64_t i) { return plan_of(i, levels_of(GetParam(), i)); });

  EXPECT_GE(tally.levels, 2 * tally.cases);
  if (GetParam() == QualityControl::removable && tally.cases >= 50) {
    EXPECT_GT(tally.rebuilt, tally.cases);
    EXPECT_TRUE(tally.kept > 0 || tally.cases < 1000);
  }
}

TEST_P(TwinOf, AgreesOnRandomMeshesRefinedByAllRanksTogether) {
  const auto tally = compare_together([](std::uint64_t i) { return plan_of(50000 + i, levels_of(GetParam(), i)); });

  EXPECT_GT(tally.levels, tally.cases);
}

/// A policy drawn anew for each level: families that another policy has broken stand beside whole ones.
std::vector<QualityControl> drawn_levels(std::uint64_t seed) {
  std::vector<QualityControl> policy;
  for (std::uint64_t level = 0; level < 3 + seed % 2; ++level)
    policy.push_back(static_cast<QualityControl>(combine(seed, level) % 4));
  return policy;
}

TEST(Twin, AgreesWhenThePolicyChangesFromLevelToLevel) {
  const auto tally = compare_alone([](std::uint64_t i) { return plan_of(100000 + i, drawn_levels(i)); });
  compare_together([](std::uint64_t i) { return plan_of(200000 + i, drawn_levels(i)); });

  if (tally.cases >= 50) {
    EXPECT_GT(tally.rebuilt, tally.cases);
    EXPECT_GT(tally.kept, 0);
  }
}

/// On a shallow dome nodes are neither smoothed nor do they back off.
Plan plan_on_dome(std::uint64_t seed) {
  return {seed, levels_of(static_cast<QualityControl>(seed % 4), seed / 4), false, true};
}

TEST(Twin, AgreesUnderACurvedBoundary) {
  const auto tally = compare_alone([](std::uint64_t i) { return plan_on_dome(i); });
  compare_together([](std::uint64_t i) { return plan_on_dome(300000 + i); });

  EXPECT_GT(tally.levels, tally.cases);
  EXPECT_TRUE(tally.rebuilt > 0 || tally.cases < 50);
}

}  // namespace twin_test
}  // namespace pamr
