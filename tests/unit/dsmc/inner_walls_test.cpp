// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <string>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "solvers/dsmc/run/gas_patches.hpp"
#include "solvers/dsmc/run/plan.hpp"
#include "support/inner_patch.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/stream_case.hpp"

/// Thin walls inside the gas.
namespace inner_walls_test {

using namespace pamr;
using namespace pamr::dsmc;

/// The unit cube with a patch "plate" of the faces in x = 0.5 whose centroids it holds.
mesh::DistMesh cube_with_plate(const par::Comm& comm, const std::function<bool(Vec3)>& holds) {
  auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 4));
  test::add_inner_patch(mesh, "plate", [&](Vec3 normal, Vec3 center) {
    return normal.y == 0 && normal.z == 0 && center.x == 0.5 && holds(center);
  });
  return mesh;
}

bool is_in_the_middle(Vec3 p) { return p.y > 0.25 && p.y < 0.75 && p.z > 0.25 && p.z < 0.75; }
bool is_anywhere(Vec3) { return true; }

/// A case with these conditions on the six sides and on the plate.
std::string case_with(const std::string& sides, const std::string& plate, const std::string& initial) {
  std::string text = test::stream_case;
  const auto put = [&](const std::string& begin, const std::string& end, const std::string& now) {
    const auto first = text.find(begin);
    text.replace(first, text.find(end) - first, now);
  };
  std::string boundary = "[boundary]\n";
  for (const char* side : {"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"})
    boundary += std::string(side) + " = { kind = \"" + sides + "\" }\n";
  put("[boundary]", "[initial]", boundary + plate + "\n");
  put("[initial]", "[particles]", initial);
  put("per_cell = 8.0", "\n[domain]", "total = 12000.0");
  put("step = 5e-5", "\n[run]", "step = 2e-4");
  put("speed = 600.0", "\n[stream.puff]", "velocity = [700.0, 250.0, 0.0]");
  put("transient = 30", "\n[reference]", "transient = 40\nsampling = 160\nblock = 8");
  return text;
}

std::string refusal(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& plate) {
  try {
    make_setup(comm, read_case(case_with("inflow", plate, ""), "case.toml"), mesh);
    return "";
  } catch (const Error& error) {
    return error.what();
  }
}

TEST(InnerWalls, BothSidesOfAPlateInAFreeMolecularStreamHaveTheLoadsOfTheClosedForms) {
  const par::Comm comm(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  const auto c = read_case(
      case_with("inflow",
                "plate = { kind = \"maxwell\", temperature = 400.0, accommodation = 0.2, front = [-1.0, 0.5, 0.0] }\n"
                "\"plate:back\" = { kind = \"diffuse\", temperature = 250.0 }",
                "[collisions]\nenabled = false\n"),
      "case.toml");
  auto run = test::filled(comm, c, cube_with_plate(comm, is_in_the_middle));
  auto serial = test::filled(alone, c, cube_with_plate(alone, is_in_the_middle));
  while (!run->is_complete()) run->step();
  while (!serial->is_complete()) serial->step();

  const auto results = run->averaging().results(), of_one = serial->averaging().results();
  ASSERT_EQ(results.walls.size(), 2U);
  EXPECT_EQ(results.walls[0].patch, "plate:front");
  EXPECT_EQ(results.walls[1].patch, "plate:back");
  for (std::size_t side = 0; side < 2; ++side) {
    const auto& wall = results.walls[side];
    auto of_side = c;
    of_side.reference.patches = {wall.patch};
    const auto& mesh = serial->mesh();
    const auto plan = make_plan(alone, of_side, make_setup(alone, of_side, mesh), mesh);
    ASSERT_TRUE(plan.body && plan.body->free_molecular) << wall.patch;
    const auto& k = *plan.body->free_molecular;
    EXPECT_NEAR(wall.drag.value, k.drag, 5 * wall.drag.error) << wall.patch;
    EXPECT_NEAR(wall.lift.value, k.lift, 5 * wall.lift.error) << wall.patch;
    EXPECT_NEAR(wall.heat.value, k.heat, 5 * wall.heat.error) << wall.patch;
    EXPECT_LT(wall.drag.error, 0.03 * results.walls[0].drag.value) << wall.patch;
    EXPECT_EQ(wall.drag.value, of_one.walls[side].drag.value) << wall.patch;
    EXPECT_EQ(wall.heat.value, of_one.walls[side].heat.value) << wall.patch;
  }
  EXPECT_GT(results.walls[0].drag.value, 10 * std::abs(results.walls[1].drag.value));  // the front faces the stream
}

TEST(InnerWalls, AWallAcrossKeepsTheGasOnItsSide) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto c =
      read_case(case_with("specular", "plate = { kind = \"diffuse\", temperature = 400.0, inside = [-3.0, 0.5, 0.5] }",
                          "[initial]\nstream = \"vacuum\"\n[[initial.region]]\nbox = [0.0, 0.0, 0.0, 0.5, 1.0, 1.0]\n"
                          "stream = \"free\"\n[collisions]\nenabled = false\n"),
                "case.toml");
  auto run = test::filled(comm, c, cube_with_plate(comm, is_anywhere));
  const auto count = [&] { return comm.sum(static_cast<std::int64_t>(run->flow().particles.size())); };
  const auto before = count();
  ASSERT_GT(before, 1000);
  for (int step = 0; step < 60; ++step) run->step();

  EXPECT_EQ(count(), before);
  const auto& x = run->flow().particles.x;
  EXPECT_TRUE(std::all_of(x.begin(), x.end(), [](double place) { return place <= 0.5; }));
  // The front looks away from the point, into the vacuum.
  std::array<std::int64_t, 2> hits{};
  const auto& wall = run->flow().setup().inner_wall.at(0);
  for (std::size_t f = 0; f < run->flow().domain().boundary.size(); ++f)
    for (std::size_t side = 0; side < 2; ++side)
      if (run->flow().domain().boundary[f].patch == wall.side[side]) hits[side] += run->flow().surface.face[f].hits;
  comm.sum_in_place(hits);
  EXPECT_EQ(hits[0], 0);
  EXPECT_GT(hits[1], 1000);
}

TEST(InnerWalls, APatchInsideThatNoTableNamesIsOpen) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = cube_with_plate(comm, is_anywhere);
  for (const char* plate : {"", "\"*\" = { kind = \"diffuse\", temperature = 300.0 }"}) {
    const auto setup = make_setup(comm, read_case(case_with("inflow", plate, ""), "case.toml"), mesh);
    EXPECT_TRUE(setup.inner_wall.empty()) << plate;
    EXPECT_EQ(setup.patches, mesh.info.patches);
  }
}

TEST(InnerWalls, SidesThatTheCaseDoesNotTellApartAreRefused) {
  const par::Comm comm(MPI_COMM_WORLD);
  const auto mesh = cube_with_plate(comm, is_in_the_middle);
  const std::string wall = "kind = \"diffuse\", temperature = 300.0";
  const std::vector<std::pair<std::string, std::string>> cases{
      {"plate = { " + wall + " }", "expected front = [x, y, z]"},
      {"plate = { " + wall + ", front = [0.0, 1.0, 0.0] }", "tells the sides of \"plate\" apart"},
      {"plate = { " + wall + ", inside = [0.5, 0.0, 0.0] }", "tells the sides of \"plate\" apart"},
      {"plate = { " + wall + ", front = [0.0, 0.0, 0.0] }", "a direction"},
      {"plate = { " + wall + ", front = [1.0, 0.0, 0.0], inside = [0.0, 0.0, 0.0] }", "beside inside"},
      {"plate = { kind = \"outflow\" }", "expected a wall"},
      {"plate = { " + wall + ", front = [1.0, 0.0, 0.0] }\n\"plate:back\" = { " + wall + ", front = [1.0, 0.0, 0.0] }",
       "in one table"},
      {"\"plate:front\" = { " + wall + ", front = [1.0, 0.0, 0.0] }", "no table for \"plate:back\""},
      {"\"pla*\" = { " + wall + " }", "for which patches inside the gas stand alone"},
      {"\"pla*\" = { " + wall + ", front = [1.0, 0.0, 0.0] }", "several patches at once"},
      {"plate = { " + wall + ", front = [1.0, 0.0, 0.0] }\n\"plate:side\" = { " + wall + " }", "plate:side"}};
  for (const auto& [plate, words] : cases)
    EXPECT_NE(refusal(comm, mesh, plate).find(words), std::string::npos) << plate << "\n" << refusal(comm, mesh, plate);
  EXPECT_EQ(refusal(comm, mesh, "plate = { " + wall + ", front = [1.0, 0.0, 0.0] }"), "");
}

}  // namespace inner_walls_test
