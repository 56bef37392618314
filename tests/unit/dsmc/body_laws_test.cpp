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
#include "unit/dsmc/stream_case.hpp"

namespace body_laws_test {

using namespace pamr;
using namespace pamr::dsmc;

/// A ball of radius 2 m by the 20 faces of an icosahedron: laws of surfaces do not ask on which side the gas is.
std::string ball_case(const std::string& patch) {
  const std::string text = test::stream_case;
  return text.substr(0, text.find("[stream.puff]")) + "[boundary]\n" + patch +
         " = { kind = \"diffuse\", temperature = 300.0 }\n[domain]\nunit = 2.0\n[particles]\nper_cell = 8.0\n" +
         "[time]\nstep = 5e-5\n[run]\nsampling = 60\n[reference]\narea = 12.566370614359172\n";
}

struct Ball {
  explicit Ball(const par::Comm& comm)
      : mesh(assemble::assemble(comm, test::ball(comm))),
        domain(make_gas_domain(mesh, 2, 5e-5, 1)),
        the_case(read_case(ball_case(mesh.info.patches.front().name), "case.toml")),
        setup(make_setup(comm, the_case, mesh)) {}

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
  const double s = 600 / std::sqrt(2 * 1.380649e-23 * 300 / 4.65e-26);
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
