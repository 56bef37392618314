// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/free_molecular.hpp"

#include <gtest/gtest.h>

#include <boost/math/quadrature/gauss_kronrod.hpp>
#include <cmath>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/index.hpp"
#include "solvers/dsmc/flow/flow.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"
#include "solvers/dsmc/kernel/random.hpp"
#include "solvers/dsmc/run/make_setup.hpp"
#include "solvers/dsmc/run/plan.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/analytic_flows.hpp"
#include "unit/dsmc/gases.hpp"
#include "unit/dsmc/stream_case.hpp"

namespace free_molecular_test {

using namespace pamr;
using namespace pamr::dsmc;
using geometry::Vec3;
using Kind = BoundaryCondition::Kind;

BoundaryCondition maxwell(double temperature, double accommodation, Vec3 velocity = {}) {
  return {Kind::diffuse, temperature, velocity, accommodation, 1, 1, 1, -1, -1};
}
BoundaryCondition cll(double temperature, double normal, double tangential, double rotational, Vec3 velocity = {}) {
  return {Kind::cll, temperature, velocity, 1, normal, tangential, rotational, -1, -1};
}
BoundaryCondition mirror() { return {Kind::specular, 0, {}, 1, 1, 1, 1, -1, -1}; }

/// Nitrogen, and a heavy gas without rotation.
Gas mixture() {
  Gas gas;
  gas.species = {{"N2", 4.65e-26, 4.17e-10, 0.74, 273, 1, 2}, {"Xe", 2.18e-25, 5.74e-10, 0.85, 273, 1, 0}};
  gas.fraction = {0.7, 0.3};
  prepare(gas);
  return gas;
}

BoundaryFace face_with(Vec3 normal) {
  BoundaryFace face;
  face.normal = normal;
  face.area = 1;
  return face;
}

/// Pressure, shear and heat on rho V^2/2 and rho V^3/2 of nitrogen on a wall at angle theta.
test::PlateCoefficients plate(const BoundaryCondition& wall, double s, double theta) {
  const auto gas = test::nitrogen();
  const double v = s * most_probable_speed(200, gas.species[0].mass), rho = 1e20 * gas.species[0].mass;
  const Stream stream{"free", 1e20, 200, 200, {v * std::sin(theta), v * std::cos(theta), 0}, {1}};
  const auto [stress, heat] = free_molecular_law(gas, stream, {wall})(face_with({1, 0, 0}));
  const double q = 0.5 * rho * v * v;
  return {stress.x / q, stress.y / q, heat / (q * v)};
}

TEST(FreeMolecular, PlatesOfMaxwellHaveTheClosedForms) {
  for (const double s : {0.3, 1.0, 5.0, 20.0})
    for (const double degrees : {90.0, 20.0, 0.0, -20.0})
      for (const double specular : {0.0, 0.8, 1.0}) {
        const double theta = degrees * std::numbers::pi / 180;
        const auto exact = test::free_molecular_plate(s, theta, 1.7, 2, specular);
        const auto found = plate(maxwell(1.7 * 200, 1 - specular), s, theta);
        EXPECT_NEAR(found.pressure, exact.pressure, 1e-12 * (1 + exact.pressure)) << s << " " << degrees;
        EXPECT_NEAR(found.shear, exact.shear, 1e-12 * (1 + exact.shear)) << s << " " << degrees;
        EXPECT_NEAR(found.heat, exact.heat, 1e-12 * (1 + std::fabs(exact.heat))) << s << " " << degrees;
      }
}

TEST(FreeMolecular, SpheresHaveTheClosedForms) {
  for (const double s : {1.0, 5.0, 10.0}) {
    const auto drag = [&](const BoundaryCondition& wall) {
      return boost::math::quadrature::gauss_kronrod<double, 61>::integrate(
          [&](double polar) {
            const double theta = std::numbers::pi / 2 - polar;
            const auto k = plate(wall, s, theta);
            return (k.pressure * std::cos(polar) + k.shear * std::sin(polar)) * 2 * std::sin(polar);
          },
          0.0, std::numbers::pi);
    };
    EXPECT_NEAR(drag(maxwell(200, 1)), test::free_molecular_sphere_drag(s, 1), 1e-9);
    EXPECT_NEAR(drag(maxwell(600, 0.2)), test::free_molecular_sphere_drag(s, 3, 0.8), 1e-9);
    EXPECT_NEAR(drag(mirror()), test::free_molecular_sphere_drag(s, 0, 1), 1e-9);
    EXPECT_NEAR(drag(cll(600, 1, 1, 1)), test::free_molecular_sphere_drag(s, 3), 1e-6);
    EXPECT_NEAR(drag(cll(600, 0, 0, 0)), test::free_molecular_sphere_drag(s, 0, 1), 1e-6);
  }
}

TEST(FreeMolecular, WallsOfCercignaniLampisAndLordHaveTheMeansOfTheirKernel) {
  // In equilibrium with the gas every wall has the gas's pressure and takes no heat.
  const auto gas = test::nitrogen();
  const double p = 1e20 * boltzmann * 300;
  for (const double normal : {0.01, 0.3, 0.9}) {
    const auto law = free_molecular_law(gas, {"rest", 1e20, 300, 300, {}, {1}}, {cll(300, normal, 0.4, 0.2)});
    const auto [stress, heat] = law(face_with({0, 0.6, 0.8}));
    EXPECT_NEAR(norm(stress - p * Vec3{0, 0.6, 0.8}), 0, 1e-6 * p) << normal;
    EXPECT_NEAR(heat, 0, 1e-12 * p * 300) << normal;
  }

  // Against the mean length of a vector of the plane, normal about (nu, 0): Rice's distribution.
  const double c_ratio = std::sqrt(200.0 / 500);
  for (const double s : {-1.0, 0.0, 2.0, 12.0})
    for (const double normal : {0.02, 0.5}) {
      const auto rice = [&](double u) {
        const double y = (1 - normal) * u * u * c_ratio * c_ratio / normal, h = 0.5 * y;
        if (h > 300) return std::sqrt(normal * y) * (1 + 0.25 / y + 1 / (32 * y * y));
        return 0.5 * std::sqrt(std::numbers::pi * normal) * std::exp(-h) *
               ((1 + y) * std::cyl_bessel_i(0, h) + y * std::cyl_bessel_i(1, h));
      };
      const double out = boost::math::quadrature::gauss_kronrod<double, 61>::integrate(
          [&](double u) { return u * std::exp(-(u - s) * (u - s)) / test::root_pi * rice(u); }, 0.0,
          std::max(s, 0.0) + 8, 8, 1e-10);
      const double in = test::free_molecular_plate(s == 0 ? 1e-9 : std::fabs(s),
                                                   s < 0 ? -std::numbers::pi / 2 : std::numbers::pi / 2, 1, 0, 1)
                            .pressure *
                        (s == 0 ? 1e-18 : s * s) / 4;
      const double c = most_probable_speed(200, gas.species[0].mass), rho_c2 = 1e20 * gas.species[0].mass * c * c;
      const auto law =
          free_molecular_law(gas, {"free", 1e20, 200, 200, {s * c, 0, 0}, {1}}, {cll(500, normal, 0.4, 1)});
      const double found = law(face_with({1, 0, 0})).first.x / rho_c2;
      EXPECT_NEAR(found, in + out / c_ratio, 1e-6 * (in + out / c_ratio) + 1e-9) << s << " " << normal;
    }
}

/// Stress and heat by drawing molecules that reach the wall and what the wall makes of them, with their standard
/// errors.
struct Drawn {
  double mean[4] = {}, error[4] = {};
};
Drawn draw(const Gas& gas, const Stream& stream, const BoundaryCondition& wall, Vec3 normal) {
  constexpr int n = 60000;
  Drawn drawn;
  double variance[4] = {};
  for (std::size_t k = 0; k < gas.species.size(); ++k) {
    const auto& species = gas.species[k];
    const double c = most_probable_speed(stream.temperature, species.mass) / std::numbers::sqrt2;
    double sum[4] = {}, squares[4] = {};
    Random random(3, Purpose::seed, k, 0);
    for (int i = 0; i < n; ++i) {
      const auto [a, b] = random.normal_pair();
      const auto [d, unused] = random.normal_pair();
      const Motion in{stream.velocity + c * Vec3{a, b, d},
                      boltzmann * stream.rotational_temperature * random.thermal_energy(species.rotational_degrees)};
      const double towards = dot(in.velocity, normal);
      if (towards <= 0) continue;
      const auto out = reflect(wall, species, normal, in, random);
      const Vec3 push = species.mass * (in.velocity - out.velocity);
      const double heat = 0.5 * species.mass *
                              (squared_norm(in.velocity - wall.velocity) - squared_norm(out.velocity - wall.velocity)) +
                          in.rotation - out.rotation;
      const double row[4] = {push.x, push.y, push.z, heat};
      for (int j = 0; j < 4; ++j) {
        sum[j] += towards * row[j];
        squares[j] += towards * row[j] * towards * row[j];
      }
    }
    const double density = stream.density * stream.fraction[k];
    for (int j = 0; j < 4; ++j) {
      const double mean = sum[j] / n;
      drawn.mean[j] += density * mean;
      variance[j] += density * density * (squares[j] / n - mean * mean) / n;
    }
  }
  for (int j = 0; j < 4; ++j) drawn.error[j] = std::sqrt(variance[j]);
  return drawn;
}

TEST(FreeMolecular, TheLawIsTheMeanOfWhatTheWallsDoToMolecules) {
  const auto gas = mixture();
  const Vec3 normal{0, 0.6, 0.8}, along{1, 0, 0}, across{0, -0.8, 0.6};
  const std::vector<std::pair<std::string, BoundaryCondition>> walls{
      {"diffuse", maxwell(500, 1)},
      {"moving", maxwell(500, 1, 200 * along - 100 * across)},
      {"maxwell", maxwell(250, 0.2, 150 * along)},
      {"specular", mirror()},
      {"cll", cll(450, 0.3, 0.7, 0.4)},
      {"moving cll", cll(150, 0.8, 0.25, 0.9, 120 * across)}};
  for (const double towards : {-200.0, 0.0, 900.0}) {
    const Stream stream{"free", 1e20, 220, 350, towards * normal + 300 * along + 50 * across, gas.fraction};
    for (const auto& [name, wall] : walls) {
      const auto [stress, heat] = free_molecular_law(gas, stream, {wall})(face_with(normal));
      const auto drawn = draw(gas, stream, wall, normal);
      const double exact[4] = {stress.x, stress.y, stress.z, heat};
      for (int j = 0; j < 4; ++j)
        EXPECT_NEAR(drawn.mean[j], exact[j], 4.5 * drawn.error[j] + 1e-12) << name << " " << towards << " " << j;
    }
  }
}

/// The unit cube with the side x = 1 in four quarters: patches a, b, c, d.
mesh::DistMesh quartered(const par::Comm& comm) {
  auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 4));
  int side = -1;
  for (std::size_t p = 0; p < mesh.info.patches.size(); ++p)
    if (mesh.info.patches[p].name == "xmax") side = static_cast<int>(p);
  const auto first = static_cast<int>(mesh.info.patches.size());
  for (const char* name : {"b", "c", "d"}) mesh.info.patches.push_back({name, "", -1});
  mesh.info.patches[at(side)].name = "a";
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto points = mesh.points(cell);
    const Vec3 center = 0.25 * (points[0] + points[1] + points[2] + points[3]);
    const int quarter = (center.y > 0.5 ? 1 : 0) + (center.z > 0.5 ? 2 : 0);
    for (auto& slot : mesh.cell_to_cell[at(cell)])
      if (slot == mesh::patch_to_slot(side) && quarter > 0) slot = mesh::patch_to_slot(first + quarter - 1);
  }
  return mesh;
}

TEST(FreeMolecular, ThePlanOfAPlateWithFourKindsOfWallsIsWhatARunFinds) {
  const par::Comm comm(MPI_COMM_WORLD);
  std::string text = test::stream_case;
  const auto put = [&](const std::string& old, const std::string& now) {
    text.replace(text.find(old), old.size(), now);
  };
  put("speed = 600.0\nangle = 20.0", "velocity = [700.0, 250.0, 0.0]");
  put("xmax = { kind = \"inflow\" }",
      "a = { kind = \"diffuse\", temperature = 700.0, velocity = [0.0, 0.0, 90.0] }\n"
      "b = { kind = \"specular\" }\nc = { kind = \"maxwell\", temperature = 400.0, accommodation = 0.2 }\n"
      "d = { kind = \"cll\", temperature = 250.0, normal_accommodation = 0.4, tangential_accommodation = 0.6, "
      "rotational_accommodation = 0.3 }");
  for (const char* side : {"ymin = { kind = \"symmetry\" }", "ymax = { kind = \"diffuse\", temperature = 400.0 }",
                           "zmin = { kind = \"diffuse\", temperature = 500.0 }", "zmax = { kind = \"outflow\" }"})
    put(side, std::string(side, 4) + " = { kind = \"inflow\" }");
  put("[particles]\nper_cell = 8.0", "[collisions]\nenabled = false\n[particles]\ntotal = 12000.0");
  put("step = 5e-5\ncell_fraction = 0.4", "step = 2e-4");
  put("transient = 30\nsampling = 60\nblock = 5", "transient = 40\nsampling = 160\nblock = 8");
  put("[[initial.region]]\nsphere = [0.2, 0.2, 0.2, 0.3]\nstream = \"puff\"", "");
  const auto mesh = quartered(comm);
  const auto c = read_case(text, "case.toml");
  const auto setup = make_setup(comm, c, mesh);
  auto run = test::filled(comm, c, mesh);
  while (!run->is_complete()) run->step();

  const auto results = run->averaging().results();
  ASSERT_EQ(results.walls.size(), 4U);
  for (const auto& wall : results.walls) {
    auto alone = c;
    alone.reference.patches = {wall.patch};
    const auto plan = make_plan(comm, alone, setup, mesh);
    ASSERT_TRUE(plan.body && plan.body->free_molecular) << wall.patch;
    const auto& k = *plan.body->free_molecular;
    EXPECT_NEAR(wall.drag.value, k.drag, 5 * wall.drag.error) << wall.patch;
    EXPECT_NEAR(wall.lift.value, k.lift, 5 * wall.lift.error) << wall.patch;
    EXPECT_NEAR(wall.heat.value, k.heat, 5 * wall.heat.error + 1e-12) << wall.patch;
    EXPECT_LT(wall.drag.error, 0.02 * k.drag) << wall.patch;
  }
}

TEST(FreeMolecular, NoValueIsGivenOfAWallThatMovesOutOfItsPlane) {
  const par::Comm comm(MPI_COMM_WORLD);
  std::string text = test::stream_case;
  const std::string old = "zmin = { kind = \"diffuse\", temperature = 500.0 ";
  text.replace(text.find(old), old.size(), old + ", velocity = [100.0, 0.0, 1.0]");
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 2));
  const auto c = read_case(text, "case.toml");
  const auto setup = make_setup(comm, c, mesh);
  const auto plan = make_plan(comm, c, setup, mesh);
  EXPECT_FALSE(plan.body->free_molecular);
  EXPECT_EQ(plan.body->moving_wall, "zmin");
  EXPECT_NE(describe(c, setup, plan).back().find("the wall zmin moves out of its plane"), std::string::npos);
  EXPECT_FALSE(to_json(plan).contains("free_molecular"));
  EXPECT_TRUE(to_json(plan).contains("newtonian"));
}

}  // namespace free_molecular_test
