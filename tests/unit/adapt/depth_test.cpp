// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/depth.hpp"

#include <gtest/gtest.h>

#include <functional>
#include <string>

#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/forecast.hpp"
#include "pamr/base/error.hpp"
#include "pamr/validate/validate.hpp"
#include "support/error_of.hpp"
#include "support/meshes.hpp"

namespace pamr {
namespace depth_test {

using geometry::Vec3;
using test::error_of;

/// A cube whose cells are of the deepest level where the corner nearest to the origin says so.
mesh::DistMesh deep_mesh(const par::Comm& comm, const std::function<int(Vec3)>& level) {
  auto mesh = assemble::assemble(comm, test::random_mesh(comm, 7, 4));
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    const auto middle = 0.25 * (p[0] + p[1] + p[2] + p[3]);
    mesh.lineage[static_cast<std::size_t>(c)] = {mesh::FamilyKind::regular, 0, 0, level(middle)};
  }
  return mesh;
}

std::vector<std::uint8_t> everywhere(const mesh::DistMesh& mesh) {
  return std::vector<std::uint8_t>(mesh.lineage.size(), 1);
}

std::int64_t count_deepest(const par::Comm& comm, const mesh::DistMesh& mesh) {
  std::int64_t n = 0;
  for (const auto lineage : mesh.lineage) n += lineage.level() == mesh::max_level ? 1 : 0;
  return comm.sum(n);
}

TEST(Depth, CellsOfTheDeepestLevelStayAndAreCounted) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = deep_mesh(comm, [](Vec3) { return mesh::max_level; });

  const auto forecast = adapt::Forecaster(comm, mesh).forecast(everywhere(mesh));
  const auto result = adapt::refine(comm, mesh, everywhere(mesh));

  EXPECT_EQ(result.report.marked_too_deep, mesh.info.n_global_cells);
  EXPECT_EQ(result.report.closure.n_marked, 0);
  EXPECT_EQ(result.report.marked_not_split, 0);
  EXPECT_EQ(result.report.cells_out, mesh.info.n_global_cells);
  EXPECT_EQ(forecast.cells, mesh.info.n_global_cells);
}

TEST(Depth, OneLevelAboveTheDeepestCanBeSplit) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = deep_mesh(comm, [](Vec3) { return mesh::max_level - 1; });

  const auto result = adapt::refine(comm, mesh, everywhere(mesh));

  EXPECT_EQ(result.report.marked_too_deep, 0);
  EXPECT_EQ(result.report.cells_out, 8 * mesh.info.n_global_cells);
  EXPECT_EQ(count_deepest(comm, result.mesh), result.report.cells_out);
}

/// Cells of a level that does not fit their size, as in files of other programs: their neighbors' splits reach them.
TEST(Depth, SplitsThatClosingMakesBeyondALevelAreCounted) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = deep_mesh(comm, [](Vec3 p) { return p.x < 0.3 ? 3 : 0; });
  std::vector<std::uint8_t> flags;
  for (const auto lineage : mesh.lineage) flags.push_back(lineage.level() < 3 ? 1 : 0);

  const auto forecast = adapt::Forecaster(comm, mesh, {.shape_floor = 1}).forecast(flags);
  const auto fine = adapt::refine(comm, mesh, flags, {.shape_floor = 1}).mesh;

  ASSERT_EQ(forecast.mesh, nullptr);
  std::int64_t n_base_cells = 0;
  for (const auto lineage : fine.lineage) n_base_cells += lineage.level() > 3 && lineage.child() == 0 ? 1 : 0;
  const auto n = comm.sum(adapt::count_splits_from_level(mesh, forecast.closure, 3));
  EXPECT_GT(n, 0);
  EXPECT_EQ(comm.sum(n_base_cells), 8 * n);
  EXPECT_EQ(comm.sum(adapt::count_splits_from_level(mesh, forecast.closure, 4)), 0);
}

TEST(Depth, ForecastAndRefinementAgreeWhereOnlyAPartIsTooDeep) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = deep_mesh(comm, [](Vec3 p) { return p.x < 0.3 ? mesh::max_level : 0; });
  std::vector<std::uint8_t> flags;  // a corner far from the deep cells, and all of these
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto p = mesh.points(c);
    const auto middle = 0.25 * (p[0] + p[1] + p[2] + p[3]);
    flags.push_back(middle.x < 0.3 || (middle.x > 0.8 && middle.y > 0.8) ? 1 : 0);
  }

  const auto forecast = adapt::Forecaster(comm, mesh).forecast(flags);
  auto moved = mesh;
  const auto result = adapt::refine(comm, mesh, flags);
  const auto balanced = adapt::refine(comm, std::move(moved), flags);

  EXPECT_EQ(result.report.marked_too_deep, count_deepest(comm, mesh));
  EXPECT_EQ(balanced.report.marked_too_deep, count_deepest(comm, mesh));
  EXPECT_GT(result.report.closure.n_marked, 0);
  EXPECT_EQ(result.report.cells_out, forecast.cells);
  EXPECT_EQ(balanced.report.cells_out, forecast.cells);
  EXPECT_TRUE(validate::validate(comm, result.mesh).empty());
}

TEST(Depth, ACellThatClosingWouldSplitIsNamedByForecastAndRefinement) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto is_marked = [](Vec3 p) { return p.x < 0.45 || p.x > 0.55; };
  const auto mesh = deep_mesh(comm, [&](Vec3 p) { return is_marked(p) ? 0 : mesh::max_level; });
  std::vector<std::uint8_t> flags;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    flags.push_back(mesh.lineage[static_cast<std::size_t>(c)].level() == 0 ? 1 : 0);

  const auto of_forecast = error_of([&] { adapt::Forecaster(comm, mesh).forecast(flags); });
  const auto of_refinement = error_of([&] { adapt::refine(comm, mesh, flags); });

  EXPECT_NE(of_forecast.find("the deepest there is"), std::string::npos) << of_forecast;
  EXPECT_EQ(of_forecast, of_refinement);
  EXPECT_EQ(of_forecast, comm.broadcast(of_forecast));
}

}  // namespace depth_test
}  // namespace pamr
