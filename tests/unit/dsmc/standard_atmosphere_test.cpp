// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/gas/standard_atmosphere.hpp"

#include <gtest/gtest.h>

#include <array>
#include <vector>

#include "pamr/base/contract.hpp"
#include "solvers/dsmc/gas/gas.hpp"

namespace standard_atmosphere_test {

using namespace pamr::dsmc;

TEST(StandardAir, HasTheTabulatedValues) {
  struct Row {
    double altitude, temperature;   ///< table I
    std::array<double, 5> density;  ///< table VIII: N2, O2, O, Ar, He
  };
  const std::vector<Row> table{{86e3, 186.87, {1.130e20, 3.031e19, 8.600e16, 1.351e18, 7.582e14}},
                               {90e3, 186.87, {5.547e19, 1.479e19, 2.443e17, 6.574e17, 3.976e14}},
                               {95e3, 188.42, {2.268e19, 5.830e18, 4.365e17, 2.583e17, 1.973e14}},
                               {100e3, 195.08, {9.210e18, 2.151e18, 4.298e17, 9.501e16, 1.133e14}},
                               {105e3, 208.84, {3.883e18, 7.645e17, 3.406e17, 3.299e16, 7.633e13}},
                               {110e3, 240.00, {1.641e18, 2.621e17, 2.303e17, 1.046e16, 5.821e13}},
                               {120e3, 360.00, {3.726e17, 4.395e16, 9.275e16, 1.366e15, 3.888e13}},
                               {150e3, 634.39, {3.124e16, 2.750e15, 1.780e16, 5.000e13, 2.106e13}},
                               {200e3, 854.56, {2.925e15, 1.918e14, 4.050e15, 1.938e12, 1.310e13}}};
  for (const auto& row : table) {
    const auto air = standard_air(row.altitude);

    EXPECT_NEAR(air.temperature, row.temperature, 0.0051) << row.altitude;
    for (std::size_t s = 0; s < air_species.size(); ++s)
      EXPECT_NEAR(air.density[s] / row.density[s], 1, 1e-3) << row.altitude << " " << air_species[s];
  }
}

TEST(StandardAir, IsMixedBelowAndHasThePressureOfTheTables) {
  const auto pressure = [](const Air& air) { return air.total() * boltzmann * air.temperature; };
  const auto low = standard_air(80e3), middle = standard_air(85e3), high = standard_air(86e3),
             above = standard_air(86001);

  EXPECT_NEAR(low.temperature, 198.639, 5e-4);
  EXPECT_NEAR(pressure(low), 1.0524, 2e-4);
  EXPECT_NEAR(pressure(middle), 0.44568, 5e-5);
  EXPECT_NEAR(low.density[0] / low.total(), 0.7811, 1e-4);
  EXPECT_EQ(low.density[2], 0);
  for (std::size_t s = 0; s < air_species.size(); ++s)
    EXPECT_NEAR(above.density[s] / high.density[s], 1, 5e-4) << air_species[s];
}

TEST(StandardAir, EndsWhereItIsNotDefined) {
  for (const double altitude : {79999.0, 200001.0, -1.0}) EXPECT_THROW(standard_air(altitude), pamr::ContractViolation);
}

}  // namespace standard_atmosphere_test
