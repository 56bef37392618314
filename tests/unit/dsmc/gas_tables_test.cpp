// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/gas/gas_tables.hpp"

#include <gtest/gtest.h>

#include <string>

#include "pamr/base/error.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"
#include "solvers/dsmc/gas/standard_atmosphere.hpp"

namespace gas_tables_test {

using namespace pamr;
using namespace pamr::dsmc;

Gas gas_of(const std::string& text) { return read_gas(parse_toml(text, "case.toml"), "case.toml"); }

Gas only(const std::string& name) { return gas_of("[gas]\nfractions = { " + name + " = 1.0 }\n"); }

/// The error message for a case with this text.
std::string refusal(const std::string& text) {
  try {
    const auto file = parse_toml(text, "case.toml");
    read_streams(file.table("stream"), read_gas(file, "case.toml"));
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

TEST(KnownGases, HaveTheMassesAndViscositiesOfTheirSource) {
  struct Row {
    const char* name;
    double weight;     ///< g/mol
    double viscosity;  ///< Pa s at 273 K, Bird 1994, table A1; 0: none there
    int rotational_degrees;
  };
  for (const auto& row :
       {Row{"N2", 28.013, 1.656e-5, 2}, Row{"O2", 31.999, 1.919e-5, 2}, Row{"NO", 30.006, 1.774e-5, 2},
        Row{"O", 15.999, 0, 0}, Row{"N", 14.007, 0, 0}, Row{"Ar", 39.948, 2.117e-5, 0}, Row{"He", 4.0026, 1.865e-5, 0},
        Row{"H2", 2.016, 0.845e-5, 2}, Row{"CO2", 44.010, 1.380e-5, 2}}) {
    const auto gas = only(row.name);

    ASSERT_EQ(gas.species.size(), 1U);
    const auto& s = gas.species.front();
    EXPECT_NEAR(s.mass * 6.02214076e26 / row.weight, 1, 3e-3) << row.name;
    EXPECT_EQ(s.rotational_degrees, row.rotational_degrees) << row.name;
    EXPECT_EQ(s.alpha, 1) << row.name;
    if (row.viscosity > 0) {
      EXPECT_NEAR(viscosity(s, 273) / row.viscosity, 1, 0.01) << row.name;
    }
  }
}

TEST(KnownGases, GiveWayToTablesOfTheCase) {
  const std::string own = "[species.N2]\nmass = 4.6e-26\ndiameter = 4e-10\nomega = 0.7\nt_ref = 300.0\n";

  const auto gas = gas_of(own + "[gas]\nfractions = { N2 = 0.5, O2 = 0.5 }\n");

  EXPECT_EQ(gas.species[0].mass, 4.6e-26);
  EXPECT_EQ(gas.species[0].rotational_degrees, 0);
  EXPECT_EQ(gas.species[1].mass, 5.312e-26);
  EXPECT_NE(refusal("[gas]\nfractions = { N3 = 1.0 }\n[stream.free]\ndensity = 1e20\ntemperature = 300.0\n").find("N3"),
            std::string::npos);
}

TEST(Altitude, SetsDensityTemperatureAndComposition) {
  const auto file = parse_toml("[stream.free]\naltitude = 100e3\nvelocity = [7500.0, 0.0, 0.0]\n", "case.toml");
  const auto air = standard_air(100e3);

  const auto gas = read_gas(file, "case.toml");
  const auto free = read_streams(file.table("stream"), gas).front();

  file.finish();
  EXPECT_EQ(free.density, air.total());
  EXPECT_EQ(free.temperature, air.temperature);
  EXPECT_EQ(free.rotational_temperature, air.temperature);
  ASSERT_EQ(gas.species.size(), air_species.size());
  EXPECT_EQ(gas.fraction, free.fraction);
  for (std::size_t i = 0; i < gas.species.size(); ++i)
    for (std::size_t a = 0; a < air_species.size(); ++a)
      if (gas.species[i].name == air_species[a]) {
        EXPECT_EQ(free.fraction[i], air.density[a] / air.total());
      }
}

TEST(Altitude, LeavesAGasOfTheCaseAndFractionsOfTheStreamAsTheyAre) {
  const std::string gas_text = "[gas]\nfractions = { N2 = 1.0, O2 = 0.0, O = 0.0, Ar = 0.0, He = 0.0, NO = 0.0 }\n";
  const auto all = parse_toml(gas_text + "[stream.free]\naltitude = 150e3\n", "case.toml");
  const auto gas = read_gas(all, "case.toml");
  const auto free = read_streams(all.table("stream"), gas).front();
  EXPECT_EQ(gas.species.size(), 6U);
  EXPECT_EQ(gas.species.front().name, "Ar");
  EXPECT_NEAR(free.fraction.front(), 5.000e13 / 5.186e16, 1e-6);

  const auto two = parse_toml(
      "[gas]\nfractions = { N2 = 0.8, O2 = 0.2 }\n[stream.free]\naltitude = 90e3\nfractions = { N2 = 0.7, O2 = 0.3 }\n",
      "case.toml");
  EXPECT_EQ(read_streams(two.table("stream"), read_gas(two, "case.toml")).front().fraction[1], 0.3);
}

TEST(Altitude, IsRefusedWhereItSaysTooLittleOrTooMuch) {
  const std::string gas = "[gas]\nfractions = { N2 = 0.8, O2 = 0.2 }\n", free = "[stream.free]\naltitude = 100e3\n";
  EXPECT_NE(refusal(gas + free).find("expected O among the fractions of [gas]"), std::string::npos)
      << refusal(gas + free);
  for (const std::string more : {"density = 1e20\n", "temperature = 300.0\n"})
    EXPECT_NE(refusal(free + more).find("case.toml:3:"), std::string::npos) << refusal(free + more);
  for (const std::string altitude : {"79.9e3", "201e3", "100"})
    EXPECT_NE(refusal("[stream.free]\naltitude = " + altitude + "\n").find("case.toml:2:"), std::string::npos)
        << altitude;
  EXPECT_NE(refusal("[stream.free]\ndensity = 1e20\ntemperature = 300.0\n").find("[gas]"), std::string::npos);
}

}  // namespace gas_tables_test
