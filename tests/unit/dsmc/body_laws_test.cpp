// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/body_laws.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <string>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "solvers/dsmc/run/make_setup.hpp"
#include "solvers/dsmc/sampling/exact_walls.hpp"
#include "support/meshes.hpp"
#include "support/round_bodies.hpp"
#include "unit/dsmc/analytic_flows.hpp"

namespace body_laws_test {

using namespace pamr;
using namespace pamr::dsmc;

/// A ball of radius 2 m by the 20 faces of an icosahedron: laws of surfaces do not ask on which side the gas is.
const char* const ball_case = R"(
[species.N2]
mass = 4.65e-26
diameter = 4.17e-10
omega = 0.74
t_ref = 273.0
rotational_degrees = 2
[gas]
fractions = { N2 = 1.0 }
[stream.free]
density = 1e20
temperature = 300.0
speed = 2110.26
[boundary]
"*" = { kind = "diffuse", temperature = 300.0 }
[particles]
per_cell = 8.0
[domain]
unit = 2.0
[time]
step = 5e-5
[run]
transient = 30
sampling = 60
block = 5
[reference]
area = 12.566370614359172
)";

struct Ball {
  explicit Ball(const par::Comm& comm)
      : mesh(assemble::assemble(comm, test::ball(comm))),
        domain(make_gas_domain(mesh, 2, 5e-5, 1)),
        the_case(read_case(with_patch(mesh.info.patches.front().name), "case.toml")),
        setup(make_setup(comm, the_case, mesh)) {}

  static std::string with_patch(const std::string& name) {
    std::string text = ball_case;
    return text.replace(text.find("\"*\""), 3, name);
  }

  mesh::DistMesh mesh;
  GasDomain domain;
  Case the_case;
  Setup setup;
};

TEST(FacesOnSurfaces, LackLittleOfTheAreaThatFlatFacesLack) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Ball ball(comm);
  const auto lacks = [&](const std::vector<BoundaryFace>& faces) {
    std::vector<par::ExactSum> area(1);
    for (const auto& face : faces) area[0].add(face.area);
    return 16 * std::numbers::pi - par::reproducible_sums(comm, area)[0];
  };
  const auto parts = faces_on_surfaces(ball.domain.boundary, ball.mesh.info.patches, *ball.mesh.info.surfaces, 2);
  EXPECT_EQ(parts.size(), 16 * ball.domain.boundary.size());
  EXPECT_GT(lacks(parts), 0);
  EXPECT_LT(lacks(parts), lacks(ball.domain.boundary) / 12);  // the faces are so coarse that it is not 16 yet
  for (const auto& part : parts) {
    EXPECT_NEAR(norm(part.center()), 2, 0.06);
    EXPECT_GT(dot(part.normal, part.center()), 1.9);
  }
  const auto free_patch = std::vector<mesh::Patch>(1);
  EXPECT_EQ(faces_on_surfaces(ball.domain.boundary, free_patch, *ball.mesh.info.surfaces, 2).size(),
            ball.domain.boundary.size());
}

TEST(BodyLaws, TheErrorOfFlatFacesIsWhatABallLacksOfItsClosedForms) {
  const par::Comm comm(MPI_COMM_WORLD);
  const Ball ball(comm);
  const auto flat = body_laws(comm, ball.the_case, ball.setup, ball.mesh.info.patches, ball.domain.boundary);
  ASSERT_TRUE(flat.free_molecular);
  const double s = 2110.26 / std::sqrt(2 * 1.380649e-23 * 300 / 4.65e-26);
  const double drag = test::free_molecular_sphere_drag(s, 1), heat = test::free_molecular_sphere_heat(s, 1, 2);
  EXPECT_LT(flat.newtonian.drag, 0.9);
  EXPECT_LT(flat.free_molecular->drag, 0.95 * drag);

  const auto error = error_of_facets(comm, ball.the_case, ball.setup, ball.mesh, ball.domain.boundary);

  const double newtonian = 1 - flat.newtonian.drag, free_molecular = drag - flat.free_molecular->drag;
  EXPECT_NEAR(error.drag, std::max(newtonian, free_molecular), 0.1 * std::max(newtonian, free_molecular));
  EXPECT_NEAR(error.heat, heat - flat.free_molecular->heat, 0.1 * error.heat);
}

TEST(BodyLaws, FlatPatchesHaveNoErrorOfFacets) {
  const par::Comm comm(MPI_COMM_WORLD);
  Ball ball(comm);
  for (auto* patches : {&ball.mesh.info.patches, &ball.setup.patches})
    for (auto& patch : *patches) patch.surface = -1;
  const auto error = error_of_facets(comm, ball.the_case, ball.setup, ball.mesh, ball.domain.boundary);
  EXPECT_EQ(error.drag, 0);
  EXPECT_EQ(error.heat, 0);
}

TEST(BodyLaws, SurfacesThatWereNotReadAreNotTakenForFlatOnes) {
  const par::Comm comm(MPI_COMM_WORLD);
  Ball ball(comm);
  auto surfaces = *ball.mesh.info.surfaces;
  for (auto& surface : surfaces.surface) surface = nullptr;
  ball.mesh.info.surfaces = std::make_shared<const geometry::SurfaceSet>(surfaces);
  EXPECT_THROW(error_of_facets(comm, ball.the_case, ball.setup, ball.mesh, ball.domain.boundary), Error);
}

}  // namespace body_laws_test
