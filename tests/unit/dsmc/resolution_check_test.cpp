// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/resolution_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "pamr/adapt/adapt.hpp"
#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/validate/validate.hpp"
#include "solvers/dsmc/run/split_walls.hpp"
#include "support/inner_patch.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/stream_case.hpp"

namespace resolution_check_test {

using namespace pamr;
using namespace pamr::dsmc;

TEST(CheckedCoefficient, HasTheErrorOfAValueThatIsAsTheRootOfAViscosityThatGrowsByTheSquareOfTheDistance) {
  for (const double off : {0.02, -0.5, 3.0})
    for (const double n : {8.0, 100.0})
      for (const double far : {1e-3, 0.5, 2.0, 100.0}) {
        const auto separation = [&](double particles) { return far * std::pow(particles / n, -1.0 / 3); };
        const auto error = [&](double particles) { return off * (std::hypot(1, separation(particles)) - 1); };
        const CheckedCoefficient one{"C_D", {1 + error(n), 0}, 1, 0, {{{1 + error(n / 4), 0}, 1, separation(n)}}};
        EXPECT_NEAR(one.error(), std::fabs(error(n)), 1e-12 * std::fabs(off) / (far * far) + 1e-12 * far)
            << off << ", " << n;
        EXPECT_NEAR(one.bound(), one.error(), 1e-15);
      }
  EXPECT_NEAR(error_of_particles_per_difference(0), 1 / (std::pow(4, 2.0 / 3) - 1), 1e-15);
  EXPECT_NEAR(error_of_particles_per_difference(1e9), 1 / (std::cbrt(4) - 1), 1e-8);
  EXPECT_NEAR(error_of_cells_per_difference(0), 4.0 / 3, 1e-15);
  EXPECT_NEAR(error_of_cells_per_difference(1e9), 2, 1e-8);
}

TEST(CheckedCoefficient, PartsTheErrorOfCellsFromThatOfPartnersWhoAreFartherApartInSmallerCells) {
  const auto law = [](double x) { return std::hypot(1, x) - 1; };
  for (const double of_particles : {0.05, -0.2})
    for (const double of_cells : {0.1, -0.03})
      for (const double distance : {0.8, 1.0, 1.6})
        for (const double apart : {0.1, 2.0})
          for (const double size : {0.5, 20.0}) {
            const auto value = [&](double s, double h) {
              const double viscous = std::sqrt(16 / (45 * std::acos(-1))) * h;
              return Estimate{1.3 + of_particles * law(s) + of_cells * law(viscous), 0};
            };
            CheckedCoefficient one{"C_D", value(apart, size), 1, 0, {{value(std::cbrt(4) * apart, size), 1, apart}}};
            one.split = {value(distance * apart, size / 2), 1, size, distance};
            EXPECT_NEAR(one.error_of_cells(), std::fabs(one.all.value - value(apart, 0).value), 1e-12);
            EXPECT_NEAR(one.error(), std::fabs(one.all.value - value(0, size).value), 1e-12);
            EXPECT_NEAR(one.bound(), one.error() + one.error_of_cells(), 1e-15);
          }
}

TEST(CheckedCoefficient, HidesNoErrorOfCellsBelowTheNoiseOfAllRuns) {
  CheckedCoefficient one{"C_D", {1.3, 0.003}, 2.2, 0, {{{1.3, 0.005}, 2.1, 1e-9}}};
  one.split = {{1.301, 0.004}, 2.2, 0, 1};
  EXPECT_NEAR(one.difference_of_cells().error, 0.005, 1e-15);
  EXPECT_NEAR(one.error_of_cells(), 4.0 / 3 * 2 * 0.005, 1e-12);
  one.split->distance = std::sqrt(2.0);  // as far apart as with 2^(-3/2) of the particles: twice the error of these
  const double part = 1 / (std::pow(4, 2.0 / 3) - 1);
  EXPECT_NEAR(one.difference_of_cells().error, std::hypot(0.004, (1 - part) * 0.003, part * 0.005), 1e-12);
}

/// The case's mesh with some closure cells at its walls.
mesh::DistMesh closed_mesh(const par::Comm& comm, const mesh::BlockMesh& block) {
  auto mesh = assemble::assemble(comm, block);
  std::vector<std::uint8_t> flags;
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto center = geometry::centroid(mesh.points(cell));
    flags.push_back(center.x < 0.5 && center.y < 0.5 && center.z < 0.25 ? 1 : 0);
  }
  return adapt::refine(comm, std::move(mesh), flags).mesh;
}

TEST(SplitWalls, MakesEightOfEveryCellWithAFaceOnAWallAndKeepsItsTimeStep) {
  const par::Comm comm(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  const auto c = read_case(test::stream_case, "case.toml");
  const auto block = test::kuhn_cube(comm, 3);
  const auto run = test::filled(comm, c, closed_mesh(comm, block));
  const auto twin = test::filled(alone, c, closed_mesh(alone, test::gather(comm, block)));

  const auto split = split_walls(alone, twin->mesh(), twin->flow());

  EXPECT_TRUE(validate::validate(alone, split.mesh).empty());
  const auto on_ranks = split_walls(comm, run->mesh(), run->flow());
  EXPECT_EQ(mesh::fingerprint(comm, on_ranks.mesh), mesh::fingerprint(alone, split.mesh));
  EXPECT_EQ(on_ranks.n_split, split.n_split);
  const auto& before = twin->flow();
  std::vector<bool> is_wall;
  for (const auto& condition : before.setup().patch) is_wall.push_back(condition.is_wall());
  const auto has_wall = [&](const mesh::DistMesh& mesh, LocalId cell) {
    const auto& links = mesh.cell_to_cell[at(cell)];
    return std::any_of(links.begin(), links.end(),
                       [&](LocalId link) { return link < 0 && is_wall[at(mesh::slot_to_patch(link))]; });
  };
  std::int64_t n_split = 0, n_closure = 0, n_pieces = 0;
  for (LocalId cell = 0; cell < twin->mesh().n_cells(); ++cell) {
    EXPECT_EQ(split.is_at_wall[at(cell)] != 0, has_wall(twin->mesh(), cell));
    n_split += split.is_at_wall[at(cell)];
    n_closure += has_wall(twin->mesh(), cell) && twin->mesh().lineage[at(cell)].is_closure() ? 1 : 0;
  }
  EXPECT_EQ(split.n_split, n_split);
  EXPECT_GT(n_closure, 0);
  const auto& parent = split.mesh.find_cell_field(mesh::parent_field)->integer();
  ASSERT_EQ(split.cell_dt.size(), parent.size());
  for (LocalId cell = 0; cell < split.mesh.n_cells(); ++cell) {
    const auto p = static_cast<std::size_t>(parent[at(cell)]);
    EXPECT_EQ(split.cell_dt[at(cell)], before.setup().cell_dt[p]);
    EXPECT_EQ(split.comes_from_wall[at(cell)], split.is_at_wall[p]);
    EXPECT_LE(has_wall(split.mesh, cell) ? 1 : 0, split.comes_from_wall[at(cell)]);
    if (split.comes_from_wall[at(cell)] == 0) continue;
    ++n_pieces;
    EXPECT_NEAR(geometry::volume(split.mesh.points(cell)), before.domain().volume[p] / 8, 1e-12);
  }
  EXPECT_EQ(n_pieces, 8 * n_split);
}

/// The case without its walls, with this line in [boundary].
std::string stream_past_mirrors(const std::string& line) {
  std::string text = test::stream_case;
  text.insert(text.find("[initial]"), line);
  for (const char* temperature : {"400.0", "500.0"}) {
    const auto wall = std::string("kind = \"diffuse\", temperature = ") + temperature;
    text.replace(text.find(wall), wall.size(), "kind = \"symmetry\"");
  }
  return text;
}

TEST(SplitWalls, TakesBothSidesOfAWallInside) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 4));
  test::add_inner_patch(mesh, "plate", [](geometry::Vec3 normal, geometry::Vec3 center) {
    return normal.y == 0 && normal.z == 0 && center.x == 0.5;
  });
  const auto text = stream_past_mirrors("plate = { kind = \"specular\", front = [1.0, 0.0, 0.0] }\n");
  const auto run = test::filled(comm, read_case(text, "case.toml"), std::move(mesh));

  const auto split = split_walls(comm, run->mesh(), run->flow());

  EXPECT_EQ(split.n_split, 2 * 2 * 4 * 4);  // two triangles a square, two cells a triangle
}

TEST(CheckedCoefficient, DoesNotTakeADifferenceBelowItsNoiseForNone) {
  const CheckedCoefficient hidden{"C_D", {1.3, 0.003}, 2.2, 0, {{{1.301, 0.004}, 2.1, 0}}};
  EXPECT_NEAR(hidden.difference().error, 0.005, 1e-15);
  EXPECT_NEAR(hidden.error(), 2 * 0.005 * 0.657963, 1e-8);
  EXPECT_NEAR(hidden.bound(), 2.2 * 0.003 + 2 * 0.005 * 0.657963, 1e-8);
  const CheckedCoefficient seen{"C_D", {1.3, 0.003}, 2.2, 0, {{{1.36, 0.004}, 2.1, 0}}};
  EXPECT_NEAR(seen.error(), 0.06 * 0.657963, 1e-7);
}

TEST(ResolutionCheck, GoesOnFromTheGasThatThereIsWithTheSameBitsOnAnyRanks) {
  const par::Comm comm(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  const auto c = read_case(test::stream_case, "case.toml");
  const auto block = test::kuhn_cube(comm, 3);
  auto one = test::filled(comm, c, assemble::assemble(comm, block));
  auto twin = test::filled(alone, c, assemble::assemble(alone, test::gather(comm, block)));
  for (auto* run : {&one, &twin})
    while (!(*run)->is_complete()) (*run)->step();
  const auto before = one->snapshot().header;
  CellResolution resolution;
  resolution.wall_separation = 0.3;
  resolution.wall_cell_size = 2;

  const auto check = check_resolution(*one, resolution, true, {}).value();

  EXPECT_EQ(one->snapshot().header, before);
  EXPECT_EQ(to_json(check), to_json(check_resolution(*twin, resolution, true, {}).value()));
  const auto n = static_cast<double>(one->flow().n_particles());
  EXPECT_NEAR(4.0 * static_cast<double>(check.fewer->n_particles) / n, 1, 0.2);
  // A passage, as of a flow that was carried, or the transient of the case; then as many steps as were averaged.
  EXPECT_EQ(check.fewer->n_steps,
            60 + std::max<std::uint64_t>(30, static_cast<std::uint64_t>(one->averaging().passage_steps())));
  ASSERT_EQ(check.coefficients.size(), 4U);
  const auto& drag = check.coefficients[0];
  EXPECT_EQ(drag.all.value, one->averaging().results().body.drag.value);
  EXPECT_NE(drag.difference().value, 0);
  EXPECT_GT(drag.fewer->value.error, drag.all.error);
  EXPECT_EQ(describe(check).size(), 5U);

  ASSERT_TRUE(check.split && drag.split);
  EXPECT_EQ(check.split->n_split, 2 * 2 * 9 - 3);  // of two sides with an edge in common, along which 3 cells have both
  EXPECT_GT(check.split->n_cells, 162 + 7 * check.split->n_split);
  EXPECT_NEAR(static_cast<double>(check.split->n_particles) / n, 1, 0.2);
  EXPECT_EQ(check.split->n_steps, check.fewer->n_steps);
  EXPECT_GT(check.split->particles_per_piece, 0.2);
  EXPECT_LT(check.split->particles_per_piece, 5);
  EXPECT_GT(check.split->distance, 0.3);
  EXPECT_LT(check.split->distance, 1.5);
  EXPECT_EQ(drag.split->distance, check.split->distance);
  EXPECT_EQ(drag.split->size, 2);
  EXPECT_NE(drag.split->value.value, drag.all.value);

  const auto without = check_resolution(*twin, resolution, false, {}).value();
  Observer stopped;
  stopped.wants_stop = [] { return true; };
  EXPECT_FALSE(check_resolution(*twin, resolution, true, stopped));
  EXPECT_FALSE(without.split || without.coefficients[0].split);
  EXPECT_EQ(describe(without).size(), 4U);
  EXPECT_EQ(without.coefficients[0].error(), drag.error());
  EXPECT_LT(without.coefficients[0].bound(), drag.bound());
}

TEST(ResolutionCheck, IsRefusedWithoutAveragesAndForFlowsThatChange) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto c = read_case(test::stream_case, "case.toml");
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 2));
  EXPECT_THROW(check_resolution(*test::filled(comm, c, mesh), {}, false, {}), Error);
  auto changing = c, short_one = c, without_blocks = c;
  changing.schedule.window = 20;
  EXPECT_THROW(require_checkable(changing, false), Error);
  short_one.schedule.block = short_one.schedule.sampling / 2;
  require_checkable(short_one, false);
  ++short_one.schedule.block;
  EXPECT_THROW(require_checkable(short_one, false), Error);
  without_blocks.schedule.block = 0;
  without_blocks.schedule.sampling = 1;
  EXPECT_THROW(require_checkable(without_blocks, false), Error);
}

TEST(ResolutionCheck, AddsNothingOfParticlesAndCellsWhereMoleculesDoNotCollide) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto c = read_case(test::stream_case, "case.toml");
  c.collisions.enabled = false;
  auto run = test::filled(comm, c, assemble::assemble(comm, test::kuhn_cube(comm, 3)));
  while (!run->is_complete()) run->step();

  const auto check = check_resolution(*run, {}, false, {}).value();

  EXPECT_FALSE(check.fewer);
  ASSERT_EQ(check.coefficients.size(), 4U);
  for (const auto& one : check.coefficients) EXPECT_EQ(one.bound(), one.student * one.all.error);
  EXPECT_EQ(describe(check)[0].find("C_D, molecules without collisions: "), 0U);
  EXPECT_THROW(require_checkable(c, true), Error);
}

TEST(ResolutionCheck, NeedsFacesOnAWallToSplitTheirCells) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 2));
  mesh.info.patches.emplace_back().name = "nowhere";
  const auto c = read_case(stream_past_mirrors("nowhere = { kind = \"specular\" }\n"), "case.toml");
  EXPECT_THROW(require_walls(*test::filled(comm, c, mesh)), Error);
  require_walls(*test::filled(comm, read_case(test::stream_case, "case.toml"),
                              assemble::assemble(comm, test::kuhn_cube(comm, 2))));
}

TEST(ResolutionCheck, SplitsNoCellsAtPeriodicPatches) {
  auto c = read_case(test::stream_case, "case.toml");
  require_checkable(c, true);
  c.partner["xmin"] = "xmax";
  c.partner["xmax"] = "xmin";
  EXPECT_THROW(require_checkable(c, true), Error);
  require_checkable(c, false);
}

}  // namespace resolution_check_test
