// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/gas/kinetic_theory.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "unit/dsmc/analytic_flows.hpp"
#include "unit/dsmc/gases.hpp"

namespace kinetic_theory_test {

using namespace pamr::dsmc;
constexpr double degree = std::numbers::pi / 180;

TEST(KineticTheory, FluxFactorHasItsKnownValues) {
  EXPECT_DOUBLE_EQ(flux_factor(0), 1);
  EXPECT_NEAR(flux_factor(1), 3.63398, 5e-6);
  EXPECT_NEAR(flux_factor(-1), 0.0890739, 5e-8);
  EXPECT_NEAR(flux_factor(5), 17.7245, 5e-5);
  EXPECT_NEAR(molecular_flux(1e20, 300, 6.63e-26, 0), 9.97139e21, 1e17);
}

TEST(AnalyticFlows, PlateCoefficientsHaveTheirKnownValues) {
  using pamr::test::free_molecular_plate;
  const auto along = free_molecular_plate(5, 0, 1, 2), oblique = free_molecular_plate(5, 20 * degree, 1, 2),
             facing = free_molecular_plate(5, 90 * degree, 1, 2);
  EXPECT_NEAR(along.pressure, 0.04, 5e-6);
  EXPECT_NEAR(oblique.pressure, 0.39526, 5e-6);
  EXPECT_NEAR(facing.pressure, 2.39449, 5e-6);
  EXPECT_NEAR(along.shear, 0.11284, 5e-6);
  EXPECT_NEAR(oblique.shear, 0.64347, 5e-6);
  EXPECT_NEAR(facing.shear, 0, 5e-6);
  EXPECT_NEAR(along.heat, 0.05642, 5e-6);
  EXPECT_NEAR(oblique.heat, 0.34917, 5e-6);
  EXPECT_NEAR(facing.heat, 1.02, 5e-6);
}

TEST(AnalyticFlows, SphereCoefficientsHaveTheirKnownValues) {
  EXPECT_NEAR(pamr::test::free_molecular_sphere_drag(1, 1), 4.75375, 5e-6);
  EXPECT_NEAR(pamr::test::free_molecular_sphere_drag(5, 1), 2.31553, 5e-6);
  EXPECT_NEAR(pamr::test::free_molecular_sphere_drag(10, 1), 2.13811, 5e-6);
  EXPECT_NEAR(pamr::test::free_molecular_sphere_heat(1, 1, 2), 1.78606, 5e-6);
  EXPECT_NEAR(pamr::test::free_molecular_sphere_heat(5, 1, 2), 1.03960, 5e-6);
  EXPECT_NEAR(pamr::test::free_molecular_sphere_heat(10, 1, 2), 1.00998, 5e-6);
}

TEST(KineticTheory, VariableHardSpheresHaveTheirKnownTransport) {
  const auto n2 = pamr::test::nitrogen().species[0];
  EXPECT_NEAR(viscosity(n2, 273), 1.658e-5, 5e-9);
  EXPECT_NEAR(mean_free_path(n2, 1.116e21, 13.6), 0.565e-3, 5e-7);
  EXPECT_NEAR(1 / collision_frequency(n2, 1e22, 500), 2.43426e-7, 1e-12);
}

TEST(AnalyticFlows, NormalShockHasItsKnownJumps) {
  const auto argon = pamr::test::normal_shock(8, 5.0 / 3), nitrogen = pamr::test::normal_shock(20, 1.4);
  EXPECT_NEAR(argon.density, 3.82090, 5e-6);
  EXPECT_NEAR(argon.temperature, 20.8721, 5e-5);
  EXPECT_NEAR(argon.pressure, 79.75, 5e-5);
  EXPECT_NEAR(nitrogen.density, 5.92593, 5e-6);
  EXPECT_NEAR(nitrogen.temperature, 78.7219, 5e-5);
}

TEST(Gas, TheContinuumNumberOfRelaxationIsNotTheInverseOfTheProbability) {
  Rotation rotation{Rotation::Model::z_continuum, 5, 0, 0};
  EXPECT_NEAR(relaxation_probability(rotation, 2, 0.74, 300), 0.3136, 5e-5);
  rotation.value = 7.84;
  EXPECT_NEAR(relaxation_probability(rotation, 2, 0.74, 300), 0.2, 5e-5);
  EXPECT_EQ(relaxation_probability(rotation, 0, 0.74, 300), 0);
}

}  // namespace kinetic_theory_test
