// SPDX-License-Identifier: GPL-3.0-or-later
// Levels, heat and relaxation numbers of molecules that vibrate.
#include "solvers/dsmc/gas/vibration.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "pamr/base/error.hpp"
#include "solvers/dsmc/gas/gas_tables.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"
#include "solvers/dsmc/kernel/boundary.hpp"
#include "solvers/dsmc/kernel/vibrate.hpp"

namespace vibration_test {

using namespace pamr;
using namespace pamr::dsmc;

Gas gas_of(const std::string& text) { return read_gas(parse_toml(text, "case.toml"), "case.toml"); }

Gas vibrating(const std::string& name) {
  return gas_of("[gas]\nvibration = true\nfractions = { " + name + " = 1.0 }\n");
}

/// The error message for a case with this text.
std::string refusal(const std::string& text) {
  try {
    const auto file = parse_toml(text, "case.toml");
    const auto gas = read_gas(file, "case.toml");
    if (const auto streams = file.find_table("stream")) read_streams(*streams, gas);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(Vibration, IsOfTheSpeciesOnlyWhereTheCaseAsksForIt) {
  const auto off = gas_of("[gas]\nfractions = { N2 = 0.5, Ar = 0.5 }\n");
  const auto on = gas_of("[gas]\nvibration = true\nfractions = { N2 = 0.5, Ar = 0.5 }\n");

  EXPECT_FALSE(off.is_vibrating);
  EXPECT_TRUE(off.relaxing_share.empty());
  for (const auto& s : off.species) EXPECT_TRUE(s.vibration.mode.empty());
  EXPECT_TRUE(on.is_vibrating);
  for (const auto& s : on.species) EXPECT_EQ(s.vibration.mode.size(), s.name == "N2" ? 1U : 0U) << s.name;
  EXPECT_EQ(off.heat_ratio(300), (off.mean_degrees() + 2) / off.mean_degrees());
}

TEST(Vibration, OfKnownGasesHasTheTemperaturesOfItsSource) {
  EXPECT_EQ(vibrating("N2").species[0].vibration.mode, std::vector<double>{3371});
  EXPECT_EQ(vibrating("O2").species[0].vibration.mode, std::vector<double>{2256});
  EXPECT_EQ(vibrating("NO").species[0].vibration.mode, std::vector<double>{2719});
  EXPECT_EQ(vibrating("CO2").species[0].vibration.mode, (std::vector<double>{959.66, 959.66, 1918.7, 3382.1}));
}

TEST(Vibration, IsRefusedWhereItsDataAreMissingOrWrong) {
  const std::string on = "[gas]\nvibration = true\n";
  const auto with_modes = [&](const std::string& lines, const std::string& degrees = "2") {
    return refusal(
        on + "fractions = { X = 1.0 }\n[species.X]\nmass = 4e-26\ndiameter = 4e-10\nomega = 0.7\nt_ref = 273.0\n" +
        "rotational_degrees = " + degrees + "\n[species.X.vibration]\n" + lines);
  };
  const std::string rates = "c1 = 9.1\nc2 = 220.0\n";
  EXPECT_EQ(with_modes("temperatures = [3000.0]\n" + rates), "");
  EXPECT_NE(with_modes("temperatures = [3000.0]\n" + rates, "0").find("rotational_degrees"), std::string::npos);
  EXPECT_NE(with_modes("temperatures = [0.0]\n" + rates).find("temperatures"), std::string::npos);
  EXPECT_NE(with_modes("temperatures = [3000.0]\nc1 = 9.1\n").find("c2"), std::string::npos);
  EXPECT_NE(with_modes("temperatures = [3000.0, 2000.0]\ndegeneracies = [3, 2]\n" + rates).find("1 to 4 modes"),
            std::string::npos);
  EXPECT_NE(refusal(on + "fractions = { H2 = 1.0 }\n").find("[species.H2.vibration]"), std::string::npos);
  EXPECT_NE(refusal(on + "fractions = { Ar = 1.0 }\n").find("vibration"), std::string::npos);
  const std::string stream = "[stream.free]\ndensity = 1e20\ntemperature = 300.0\nvibrational_temperature = 900.0\n";
  EXPECT_EQ(refusal(on + "fractions = { N2 = 1.0 }\n" + stream), "");
  EXPECT_NE(refusal("[gas]\nfractions = { N2 = 1.0 }\n" + stream).find("vibrational_temperature"), std::string::npos);
}

TEST(Vibration, LevelsOfEveryNumberOfModesShareAWord) {
  for (std::size_t n = 1; n <= max_modes; ++n) {
    std::uint32_t word = 0;
    for (std::size_t i = 0; i < n; ++i)
      word = levels::with(word, i, n, levels::highest(n) - static_cast<std::uint32_t>(i));
    word = levels::with(word, 0, n, 5);
    EXPECT_EQ(levels::of_mode(word, 0, n), 5U);
    for (std::size_t i = 1; i < n; ++i) EXPECT_EQ(levels::of_mode(word, i, n), levels::highest(n) - i) << n << " " << i;
  }
  EXPECT_EQ(vibrational_energy(vibrating("CO2").species[0].vibration, 0x01020304),
            4 * 959.66 + 3 * 959.66 + 2 * 1918.7 + 3382.1);
}

TEST(Vibration, HasTheHeatCapacityOfTheHarmonicOscillator) {
  for (const char* name : {"N2", "CO2"}) {
    const auto v = vibrating(name).species[0].vibration;
    for (const double t : {300.0, 1000.0, 5000.0, 40000.0}) {
      const double step = 1e-4 * t;
      const double slope = (mean_vibrational_energy(v, t + step) - mean_vibrational_energy(v, t - step)) / (2 * step);
      EXPECT_NEAR(vibrational_heat(v, t) / slope, 1, 1e-6) << name << " at " << t;
    }
    EXPECT_NEAR(vibrational_heat(v, 1e6) / static_cast<double>(v.mode.size()), 1, 1e-4);
    EXPECT_EQ(vibrational_heat(v, 0), 0);
    EXPECT_EQ(mean_vibrational_energy(v, 1), 0);
  }
  const double x = 3371.0 / 2000, closed = x * x * std::exp(x) / std::pow(std::exp(x) - 1, 2);
  const auto n2 = vibrating("N2");
  EXPECT_NEAR(vibrational_heat(n2.species[0].vibration, 2000), closed, 1e-12);
  EXPECT_NEAR(n2.heat_ratio(2000), (3.5 + closed) / (2.5 + closed), 1e-12);
}

TEST(Vibration, HasTheTemperatureOfItsEnergyInMixturesToo) {
  const auto n2 = vibrating("N2").species[0].vibration, co2 = vibrating("CO2").species[0].vibration;
  for (const double t : {250.0, 900.0, 3000.0, 20000.0}) {
    EXPECT_NEAR(temperature_of_vibration({&n2}, {7}, 7 * mean_vibrational_energy(n2, t)) / t, 1, 1e-12);
    EXPECT_NEAR(temperature_of_vibration({&co2}, {7}, 7 * mean_vibrational_energy(co2, t)) / t, 1, 1e-12);
    const double both = 3 * mean_vibrational_energy(n2, t) + 2 * mean_vibrational_energy(co2, t);
    EXPECT_NEAR(temperature_of_vibration({&n2, &co2}, {3, 2}, both) / t, 1, 1e-12);
  }
  EXPECT_EQ(temperature_of_vibration({&n2}, {7}, 0), 0);
  EXPECT_EQ(temperature_of_vibration({&n2}, {0}, 10), 0);
}

/// Of two levels that are drawn for the same energy of a pair: the part of the difference from the mean that is lost.
double share_by_draws(double x, double exponent, int n) {
  Random random(3, Purpose::collision, 1, 2);
  const Vibration mode{{x}, 1, 1, 0};  // temperature 1
  const double mean = 1 / std::expm1(x);
  double both = 0, square = 0;
  for (int i = 0; i < n; ++i) {
    const double before = thermal_levels(mode, 1, random);
    double motion = 0;  // gamma distributed, exponent + 1 = 2: the sum of two exponential ones
    for (int k = 0; k < 2; ++k) motion -= std::log(random.uniform()) / x;
    const double after = draw_level(before + motion, exponent, levels::highest(1), random);
    both += (before - mean) * (after - mean);
    square += (before - mean) * (before - mean);
  }
  return 1 - both / square;
}

TEST(Vibration, RelaxesByTheShareThatTwoDrawsOfALevelHave) {
  const RelaxingShare share(1);
  for (const double x : {0.05, 0.3, 1.0, 2.5, 5.0}) EXPECT_NEAR(share.at(x), share_by_draws(x, 1, 100000), 0.03) << x;
  EXPECT_NEAR(share.at(1e-9), 2.0 / 3, 1e-9);
  EXPECT_NEAR(share.at(0.1 - 1e-9), share.at(0.1 + 1e-9), 1e-5);
  EXPECT_GT(share.at(1e6), 0.8);
}

TEST(Vibration, RelaxesInTheTimeOfMillikanAndWhiteWithALimitAtHighTemperatures) {
  const auto time = [](const Species& s, double t) {  // p tau, atm s
    return vibration_number(s, t) / collision_frequency(s, 1, t) * boltzmann * t / 101325;
  };
  // exp(a (T^(-1/3) - b) - 18.42), with less than 1 % of the limit.
  const auto no = vibrating("NO").species[0], co2 = vibrating("CO2").species[0];
  EXPECT_NEAR(time(no, 1000) / std::exp(49.5 * (0.1 - 0.042) - 18.42), 1, 0.01);
  EXPECT_NEAR(time(co2, 1000) / std::exp(36.5 * (0.1 + 0.0193) - 18.42), 1, 0.01);
  const auto n2 = vibrating("N2").species[0], o2 = vibrating("O2").species[0];
  EXPECT_NEAR(time(n2, 4000) / std::exp(221 * (std::pow(4000, -1.0 / 3) - 0.029) - 18.42), 1, 0.01);
  EXPECT_NEAR(time(o2, 3000) / std::exp(138 * (std::pow(3000, -1.0 / 3) - 0.030) - 18.42), 1, 0.01);
  for (const auto* s : {&n2, &o2, &no, &co2})
    for (double t = 100; t < 1e6; t *= 1.1) EXPECT_GT(vibration_number(*s, t), 1) << s->name << " at " << t;
  const double limit =
      std::numbers::sqrt2 * std::numbers::pi * std::pow(4.17e-10, 2) * std::pow(273.0 / 1e5, 0.24) / (3e-21 / 4);
  EXPECT_NEAR(vibration_number(n2, 1e5) / limit, 1, 0.01);
}

TEST(Vibration, ChancesAreThoseOfTheNumberAndTheShare) {
  const auto gas = vibrating("N2");
  const double share = gas.relaxing_share[0].at(3371.0 / 5000);
  EXPECT_NEAR(vibration_chance(gas, 0, 0, 0, 5000) * vibration_number(gas.species[0], 5000) * share, 1, 1e-12);
  EXPECT_EQ(vibration_chance(gas, 0, 0, 0, 50), 0);
  EXPECT_EQ(vibration_chance(gas, 0, 0, 0, 0), 0);
}

/// Means of the levels of 100,000 molecules that come from level 7 of a mode of 3371 K to a wall of 6000 K.
double mean_level_after(const BoundaryCondition& wall, bool& only_7) {
  const auto n2 = vibrating("N2").species[0];
  Random random(1, Purpose::wall, 0, 0);
  constexpr int n = 100000;
  double sum = 0;
  only_7 = true;
  for (int i = 0; i < n; ++i) {
    const auto out = reflect(wall, n2, {0, 0, 1}, {{1, 2, 300}, 1e-20, 7}, random);
    only_7 = only_7 && out.levels == 7;
    sum += out.levels;
  }
  return sum / n;
}

TEST(Vibration, LeavesAWallAtItsTemperatureAsFarAsThatAccommodates) {
  const double mean = 1 / std::expm1(3371.0 / 6000), error = 4 * std::sqrt(mean * (mean + 1) / 1e5);
  BoundaryCondition wall;
  wall.kind = BoundaryCondition::Kind::diffuse;
  wall.temperature = 6000;
  bool only_7 = false;
  EXPECT_NEAR(mean_level_after(wall, only_7), mean, error);
  wall.accommodation = 0.25;
  EXPECT_NEAR(mean_level_after(wall, only_7), 0.25 * mean + 0.75 * 7, error + 4 * 7 / std::sqrt(1e5));
  wall.kind = BoundaryCondition::Kind::cll;
  EXPECT_NEAR(mean_level_after(wall, only_7), mean, error);
  wall.vibrational_accommodation = 0.25;
  EXPECT_NEAR(mean_level_after(wall, only_7), 0.25 * mean + 0.75 * 7, error + 4 * 7 / std::sqrt(1e5));
  wall.kind = BoundaryCondition::Kind::specular;
  mean_level_after(wall, only_7);
  EXPECT_TRUE(only_7);
}

}  // namespace vibration_test
