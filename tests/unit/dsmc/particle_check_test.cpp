// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/particle_check.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <string>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/error.hpp"
#include "support/meshes.hpp"
#include "unit/dsmc/stream_case.hpp"

namespace particle_check_test {

using namespace pamr;
using namespace pamr::dsmc;

TEST(CheckedCoefficient, HasTheErrorOfAValueThatIsAsTheRootOfAViscosityThatGrowsByTheSquareOfTheDistance) {
  for (const double off : {0.02, -0.5, 3.0})
    for (const double n : {8.0, 100.0})
      for (const double far : {1e-3, 0.5, 2.0, 100.0}) {
        const auto separation = [&](double particles) { return far * std::pow(particles / n, -1.0 / 3); };
        const auto error = [&](double particles) { return off * (std::hypot(1, separation(particles)) - 1); };
        const CheckedCoefficient one{"C_D", {1 + error(n), 0}, {1 + error(n / 4), 0}, 1, 1, separation(n)};
        EXPECT_NEAR(one.error(), std::fabs(error(n)), 1e-12 * std::fabs(off) / (far * far) + 1e-12 * far)
            << off << ", " << n;
        EXPECT_NEAR(one.bound(), one.error(), 1e-15);
      }
  EXPECT_NEAR(error_per_difference(0), 1 / (std::pow(4, 2.0 / 3) - 1), 1e-15);
  EXPECT_NEAR(error_per_difference(1e9), 1 / (std::cbrt(4) - 1), 1e-8);
}

TEST(CheckedCoefficient, DoesNotTakeADifferenceBelowItsNoiseForNone) {
  const CheckedCoefficient hidden{"C_D", {1.3, 0.003}, {1.301, 0.004}, 2.2, 2.1};
  EXPECT_NEAR(hidden.difference_error(), 0.005, 1e-15);
  EXPECT_NEAR(hidden.error(), 2 * 0.005 * 0.657963, 1e-8);
  EXPECT_NEAR(hidden.bound(), 2.2 * 0.003 + 2 * 0.005 * 0.657963, 1e-8);
  const CheckedCoefficient seen{"C_D", {1.3, 0.003}, {1.36, 0.004}, 2.2, 2.1};
  EXPECT_NEAR(seen.error(), 0.06 * 0.657963, 1e-7);
}

TEST(ParticleCheck, RunsAQuarterOfTheParticlesFromTheGasThatThereIsWithTheSameBitsOnAnyRanks) {
  const par::Comm comm(MPI_COMM_WORLD), alone(MPI_COMM_SELF);
  const auto c = read_case(test::stream_case, "case.toml");
  const auto block = test::kuhn_cube(comm, 3);
  auto one = test::filled(comm, c, assemble::assemble(comm, block));
  auto twin = test::filled(alone, c, assemble::assemble(alone, test::gather(comm, block)));
  for (auto* run : {&one, &twin})
    while (!(*run)->is_complete()) (*run)->step();
  const auto before = one->snapshot().header;

  const auto check = check_particles(*one, 0.3, {});

  EXPECT_EQ(one->snapshot().header, before);
  EXPECT_EQ(to_json(check), to_json(check_particles(*twin, 0.3, {})));
  EXPECT_NEAR(4.0 * static_cast<double>(check.n_particles) / static_cast<double>(one->flow().n_particles()), 1, 0.2);
  // A passage, as of a flow that was carried, or the transient of the case; then as many steps as were averaged.
  EXPECT_EQ(check.n_steps,
            60 + std::max<std::uint64_t>(30, static_cast<std::uint64_t>(one->averaging().passage_steps())));
  ASSERT_EQ(check.coefficients.size(), 4U);
  EXPECT_EQ(check.coefficients[0].all.value, one->averaging().results().body.drag.value);
  EXPECT_NE(check.coefficients[0].difference(), 0);
  EXPECT_GT(check.coefficients[0].fewer.error, check.coefficients[0].all.error);
  EXPECT_EQ(describe(check).size(), 4U);
}

TEST(ParticleCheck, IsRefusedWithoutAveragesAndForFlowsThatChange) {
  const par::Comm comm(MPI_COMM_WORLD);
  auto c = read_case(test::stream_case, "case.toml");
  const auto mesh = assemble::assemble(comm, test::kuhn_cube(comm, 2));
  EXPECT_THROW(check_particles(*test::filled(comm, c, mesh), 0, {}), Error);
  c.schedule.window = 20;
  EXPECT_THROW(require_checkable(c), Error);
}

}  // namespace particle_check_test
