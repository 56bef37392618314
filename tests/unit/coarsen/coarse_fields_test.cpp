// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/coarsen/coarse_fields.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "coarsen_case.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/tet_shape.hpp"

namespace pamr {
namespace coarse_fields_test {

/// Cells of the left part may be coarsened, some at the right are split.
std::vector<std::int8_t> both_ways(const mesh::DistMesh& mesh) {
  std::vector<std::int8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    const double x = 0.25 * (p[0].x + p[1].x + p[2].x + p[3].x);
    flags.push_back(static_cast<std::int8_t>(x < 0.6 ? -1 : x > 0.9 ? 1 : 0));
  }
  return flags;
}

double linear(geometry::Vec3 p) { return 3 + 2 * p.x - p.y + 0.5 * p.z; }

mesh::DistMesh with_fields(mesh::DistMesh mesh) {
  std::vector<double> u, density, one;
  std::vector<std::int64_t> region;
  for (const auto p : mesh.node_position) u.push_back(linear(p));
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    density.push_back(std::sin(static_cast<double>(mesh.cell_global[at(c)])) + 2);
    one.push_back(0.1);
    region.push_back(mesh.cell_global[at(c)] % 3 == 0 ? 7 : -2);
  }
  mesh.node_fields = {{"u", "", 1, mesh::StorageType::float64, u}};
  mesh.cell_fields = {{"density", "", 1, mesh::StorageType::float64, density},
                      {"one", "", 1, mesh::StorageType::float64, one},
                      {"region", "", 1, mesh::StorageType::int64, region}};
  return mesh;
}

double integral(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& name) {
  double sum = 0;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    sum += mesh.find_cell_field(name)->real()[at(c)] * geometry::volume(mesh.points(c));
  double total = 0;
  for (const double part : comm.all_gather(sum)) total += part;
  return total;
}

mesh::DistMesh refined(const par::Comm& comm, mesh::BlockMesh block) {
  const auto destination = test::random_destinations(comm, block, 3);
  auto mesh = assemble::assemble(comm, std::move(block), destination);
  for (int level = 0; level < 2; ++level) mesh = adapt::refine(comm, mesh, test::near_dome(mesh, 0.4)).mesh;
  return mesh;
}

TEST(CoarseFields, KeepIntegralsConstantsAndLinearFunctions) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto before = with_fields(refined(comm, test::random_mesh(comm, 5, 3)));

  const auto result = adapt::adapt(comm, before, both_ways(before));

  ASSERT_GT(result.coarsening.octets_gone, 10);
  ASSERT_GT(result.report.closure.n_marked, 10);
  const auto& mesh = result.mesh;
  const double mass = integral(comm, before, "density");
  EXPECT_NEAR(integral(comm, mesh, "density"), mass, 1e-13 * mass);
  for (const double value : mesh.find_cell_field("one")->real()) ASSERT_EQ(value, 0.1);
  for (const auto value : mesh.find_cell_field("region")->integer()) ASSERT_TRUE(value == 7 || value == -2);
  for (LocalId n = 0; n < mesh.n_nodes(); ++n)
    ASSERT_NEAR(mesh.find_node_field("u")->real()[at(n)], linear(mesh.point(n)), 1e-14);
}

TEST(CoarseFields, KeepTheIntegralAtCurvedWallsWhereThatIsAskedFor) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto before = with_fields(refined(comm, test::bulging_cube(comm, 5, 0.1)));

  adapt::Options options;
  options.refinement.integrals = {"density"};
  const auto result = adapt::adapt(comm, before, test::all_may_go(before), options);

  ASSERT_GT(result.coarsening.octets_gone, 10);
  const double mass = integral(comm, before, "density"), one = integral(comm, before, "one");
  EXPECT_NEAR(integral(comm, result.mesh, "density"), mass, 1e-13 * mass);
  EXPECT_GT(std::abs(integral(comm, result.mesh, "one") - one), 1e-6 * one) << "the wall has to move";
  for (const double value : result.mesh.find_cell_field("one")->real()) ASSERT_EQ(value, 0.1);
}

TEST(CoarseFields, KeepTheIntegralWhereCellsAreSplitAtCurvedWalls) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto before = with_fields(refined(comm, test::bulging_cube(comm, 5, 0.1)));
  const double mass = integral(comm, before, "density"), one = integral(comm, before, "one");

  const auto split = adapt::refine(comm, before, test::near_dome(before, 0.3), {.integrals = {"density"}}).mesh;
  auto flags = test::with_sign(test::near_dome(before, 0.2));
  std::replace(flags.begin(), flags.end(), std::int8_t{0}, test::go);
  adapt::Options options;
  options.refinement.integrals = {"density"};
  const auto adapted = adapt::adapt(comm, before, flags, options);

  EXPECT_GT(std::abs(integral(comm, split, "one") - one), 1e-6 * one) << "the wall has to move";
  EXPECT_NEAR(integral(comm, split, "density"), mass, 1e-13 * mass);
  ASSERT_GT(adapted.coarsening.octets_gone, 10);
  EXPECT_NEAR(integral(comm, adapted.mesh, "density"), mass, 1e-13 * mass);
  EXPECT_THROW(adapt::refine(comm, before, test::near_dome(before, 0.3), {.integrals = {"region"}}), Error);
}

TEST(CoarseFields, NameEveryOldCellAsParentOrAsMergedIntoOne) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto before = refined(comm, test::random_mesh(comm, 6, 3));

  auto flags = both_ways(before);
  std::replace(flags.begin(), flags.end(), std::int8_t{1}, std::int8_t{0});
  const auto result = adapt::adapt(comm, before, flags);

  std::vector<par::Outgoing<std::int64_t>> message{{0, result.mesh.find_cell_field("parent")->integer()}};
  const auto parents = comm.sparse_exchange(message).item;
  const auto merged = comm.sparse_exchange<coarsen::Merged>({{0, result.merged}}).item;
  if (!comm.is_first()) return;
  const std::set<std::int64_t> named(parents.begin(), parents.end());
  std::set<std::int64_t> all = named;
  for (const auto& [number, into] : merged) {
    ASSERT_TRUE(all.insert(number).second) << "cell " << number;
    ASSERT_EQ(named.count(into), 1U) << "cell " << number;
  }
  EXPECT_GT(merged.size(), 50U);
  EXPECT_EQ(std::ssize(all), before.info.n_global_cells);
}

}  // namespace coarse_fields_test
}  // namespace pamr
