// SPDX-License-Identifier: GPL-3.0-or-later
// What the closure with a shape floor promises, on random meshes and marks: one result for one set of splits, the bound
// on shapes, and families that can be taken back.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdio>
#include <filesystem>
#include <set>
#include <string>

#include "exact_mesh.hpp"
#include "pamr/adapt/adapt.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/check/shape_bound.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/io/gmsh/read_gmsh.hpp"
#include "pamr/refine/cell_shape.hpp"
#include "random_case.hpp"
#include "support/delaunay.hpp"
#include "support/dice.hpp"
#include "support/meshes.hpp"
#include "support/places.hpp"
#include "support/reference.hpp"
#include "support/reference_floor.hpp"

namespace pamr {
namespace closure_properties_test {

using geometry::Vec3;
using test::Dice;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

constexpr std::array<double, 5> floors{0.35, 0, 0.5, 0.68, 1};
double floor_of(std::uint64_t seed) { return floors[static_cast<std::size_t>(mix(seed) % floors.size())]; }

test::EdgeSet set_of(unsigned mask) {
  test::EdgeSet edges;
  for (int e = 0; e < 6; ++e)
    if ((mask >> e & 1U) != 0) edges.insert(e);
  return edges;
}

unsigned mask_of(test::EdgeSet edges) {
  unsigned mask = 0;
  for (const int e : edges) mask |= 1U << e;
  return mask;
}

/// Kuhn's cell, which is full of ties, and random ones, from well shaped to flat.
geometry::TetPoints random_cell(std::uint64_t seed) {
  Dice dice(mix(seed));
  geometry::TetPoints p{{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {1, 1, 1}}};
  if (seed % 4 == 0) return p;
  const double flatness = seed % 4 == 3 ? 0.05 : 1;
  do {
    for (auto& corner : p) corner = {dice.unit(), dice.unit(), flatness * dice.unit()};
  } while (geometry::volume(p) < 1e-3 * flatness);
  return p;
}

/// The parent of a family by the state of the family.
test::ReferenceFamily family_of(const test::ReferencePattern& pattern) {
  test::ReferenceFamily family;
  family.pattern = pattern;
  return family;
}

TEST(FloorOfOneCell, IsThatOfTheReferenceAndMonotoneForAllSetsAndAllFamilies) {
  if (par::Comm(MPI_COMM_WORLD).size() != 1) return;  // all ranks would do the same
  const auto n = test::n_cases(2, 40);
  int n_enlarged = 0;
  for (std::size_t state = 0; state < test::family_patterns().size(); ++state)
    for (std::uint64_t i = 0; i < n; ++i) {
      const auto seed = combine(state, i);
      const auto cell = random_cell(seed);
      const double floor = floor_of(seed);
      const auto family = family_of(test::family_patterns()[state]);
      const auto& known = mesh::closure_states[state];
      const refine::CellShape shape(cell, {known.mask, known.cuts});
      test::ReferenceFloor reference(cell, floor, &family);
      std::array<unsigned, 64> result{};
      for (unsigned m = 0; m < 64; ++m) {
        result[m] = shape.closed_marks(static_cast<refine::EdgeMask>(m), floor);
        ASSERT_EQ(result[m], mask_of(reference.enlarge(set_of(m))))
            << "state " << state << ", case " << i << ", floor " << floor << ", marks " << m;
        ASSERT_EQ(result[m] & m, m);
        n_enlarged += result[m] != m ? 1 : 0;
      }
      for (unsigned m = 0; m < 64; ++m) {
        ASSERT_EQ(result[result[m]], result[m]);
        for (unsigned e = 0; e < 6; ++e)
          ASSERT_EQ(result[m] & result[m | 1U << e], result[m]) << "marks " << m << " and edge " << e;
      }
    }
  EXPECT_GT(n_enlarged, 1000);
}

mesh::BlockMesh gmsh_mesh(const par::Comm& comm, const std::string& name, double scale, Vec3 origin) {
  const auto read = io::read_gmsh(comm, std::filesystem::path(PAMR_TEST_MESHES) / name);
  auto whole = test::gather_on(comm, read.mesh, 0);
  for (auto& p : whole.node_position) p = scale * (p - origin);
  return whole;
}

/// Random Delaunay meshes, one in six cases a Kuhn cube and one in six a mesh by Gmsh, all about the unit cube.
mesh::BlockMesh any_mesh(const par::Comm& self, std::uint64_t seed) {
  if (seed % 6 == 1) return test::kuhn_cube(self, 2 + static_cast<int>(seed / 6 % 2));
  if (seed % 12 == 2) return gmsh_mesh(self, "hole.msh", 0.25, {-2, -2, -2});
  if (seed % 12 == 8) return gmsh_mesh(self, "wedge.msh", 0.5, {0, 0, 0});
  return test::random_delaunay(seed);
}

mesh::DistMesh refine_once(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<std::uint8_t>& flags,
                           double shape_floor) {
  auto fine = adapt::refine(comm, mesh, flags, {.shape_floor = shape_floor, .marks_field = ""});
  EXPECT_EQ(fine.report.closure.families_kept, 0);
  return std::move(fine.mesh);
}

TEST(ClosureHistory, DoesNotShowInTheResult) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  std::int64_t n_calls = 0, n_cases = 0;
  for (const auto i : test::seeds_alone(world)) {
    SCOPED_TRACE("mesh " + std::to_string(i));
    const auto start = any_mesh(self, i);
    const double shape_floor = floor_of(i);
    auto mesh = test::scatter(self, start, 0);
    for (int level = 0; level < 3 && mesh.n_cells() < 1500; ++level)
      mesh = refine_once(self, mesh, test::mark(mesh, test::law_of(i / 6 + at(level)), combine(i, at(level))),
                         shape_floor);
    const auto expected = test::reference_fingerprint(test::gather_on(self, mesh, 0));
    const auto base = test::places_of_base_cells(test::gather_on(self, mesh, 0));
    const test::Places reached(base.begin(), base.end());

    // the same splits, asked for a few at a time and in another order
    Dice dice(mix(i));
    auto other = test::scatter(self, start, 0);
    for (;; ++n_calls) {
      const auto flags = test::flag_some(test::gather_on(self, other, 0), reached, dice);
      if (std::count(flags.begin(), flags.end(), 1) == 0) break;
      other = refine_once(self, other, flags, shape_floor);
      ASSERT_LE(other.n_cells(), mesh.n_cells()) << "more was split than in one go";
    }

    ASSERT_EQ(test::reference_fingerprint(test::gather_on(self, other, 0)), expected);
    ++n_cases;
  }
  EXPECT_GT(world.sum(n_calls), 2 * world.sum(n_cases));
}

double worst_mean_ratio(const mesh::DistMesh& mesh) {
  double worst = 1;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) worst = std::min(worst, geometry::mean_ratio(mesh.points(c)));
  return worst;
}

/// A few cells about a point that wanders, so that a mesh gets deep without becoming large.
std::vector<std::uint8_t> mark_some(const mesh::DistMesh& mesh, Dice& dice) {
  std::vector<std::uint8_t> flags(at(mesh.n_cells()), 0);
  const auto cell = static_cast<LocalId>(dice.below(static_cast<std::uint64_t>(mesh.n_cells())));
  const auto target = mesh.points(cell)[dice.below(4)];
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    double nearest = norm(p[0] - target), size = 0;
    for (std::size_t k = 1; k < 4; ++k) {
      nearest = std::min(nearest, norm(p[k] - target));
      size = std::max(size, norm(p[k] - p[0]));
    }
    flags[at(c)] = nearest < 0.5 * size && dice.below(2) == 0 ? 1 : 0;
  }
  flags[at(cell)] = 1;
  return flags;
}

TEST(ClosureBound, HoldsOverSixLevelsOfRandomMarks) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  double closest = 9;
  std::int64_t n_deep = 0;
  for (const auto i : test::seeds_alone(world)) {
    Dice dice(mix(i + 1));
    const double shape_floor = floor_of(i / 2);
    auto mesh = test::scatter(self, any_mesh(self, i), 0);
    const double bound = std::min(shape_floor, check::worst_uniform_shape(self, mesh));
    for (int level = 1; level <= 6 && mesh.n_cells() < 6000; ++level) {
      const auto flags = level % 2 == 1 ? mark_some(mesh, dice) : test::mark(mesh, test::law_of(i + at(level)), i);
      mesh = refine_once(self, mesh, flags, shape_floor);
      const double worst = worst_mean_ratio(mesh);
      ASSERT_GE(worst, bound * (1 - 1e-7)) << "mesh " << i << ", level " << level << ", floor " << shape_floor;
      if (bound > 0) closest = std::min(closest, worst / bound);
      n_deep += level == 6 ? 1 : 0;
    }
  }
  EXPECT_GT(world.sum(n_deep), 0);
  closest = world.min(closest);
  EXPECT_LT(closest, 1.01) << "a bound that nothing comes near proves little";
  if (world.is_first()) std::printf("smallest mean ratio over bound: %.6f\n", closest);
}

TEST(ClosureFamilies, FillTheirParentsAndCanBeTakenBack) {
  const par::Comm world(MPI_COMM_WORLD), self(MPI_COMM_SELF);
  std::set<int> states;
  for (const auto i : test::seeds_alone(world)) {
    SCOPED_TRACE("mesh " + std::to_string(i));
    auto mesh = test::scatter(self, test::random_delaunay(i, true), 0);
    for (int level = 0; level < 3 && mesh.n_cells() < 1500; ++level)
      mesh = refine_once(self, mesh, test::mark(mesh, test::law_of(i + at(level)), i), floor_of(i));
    const auto whole = test::gather_on(self, mesh, 0);
    const auto point = test::to_whole(whole.node_position);
    std::vector<std::uint8_t> flags(whole.cell_to_node.size(), 0);
    std::int64_t n_families = 0;
    for (const auto& [first, family] : test::read_families(test::pieces_of(whole))) {
      test::Wide sum = 0;
      for (const auto& member : family.member) sum += test::six_volumes(point, member.corner);
      ASSERT_TRUE(sum == test::six_volumes(point, family.parent.corner)) << "family of cell " << first;
      states.insert(family.member.front().lineage.state());
      flags[at(first)] = 1;
      ++n_families;
    }
    ASSERT_EQ(n_families, std::count_if(whole.lineage.begin(), whole.lineage.end(),
                                        [](mesh::Lineage l) { return l.is_closure() && l.child() == 0; }));

    const auto fine = adapt::refine(self, mesh, flags, {.shape_floor = floor_of(i), .marks_field = ""});

    ASSERT_GE(fine.report.closure.families_rebuilt, n_families);
    ASSERT_EQ(fine.report.closure.families_kept, 0);
    ASSERT_EQ(fine.report.marked_not_split, 0);
  }
  const auto n_states = static_cast<std::int64_t>(states.size());
  EXPECT_GT(world.max(n_states), world.size() == 1 ? 100 : 10);
}

}  // namespace closure_properties_test
}  // namespace pamr
