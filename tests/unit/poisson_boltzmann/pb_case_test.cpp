// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/problem/pb_case.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pamr/base/error.hpp"

namespace pamr::poisson_boltzmann {
namespace pb_case_test {

const std::string wall = "[boundary.wall]\nkind = \"potential\"\nvalue = 2\n";
const std::string sphere_boundary = "[boundary.ball]\nkind = \"potential\"\nvalue = 3\n";

std::string error_of(const std::string& text) {
  try {
    read_case(text, "case.toml");
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(ReadCase, TakesDefaultsForAllButTheBoundary) {
  const auto problem = read_case(wall, "case.toml");

  ASSERT_EQ(problem.boundary.size(), 1U);
  EXPECT_EQ(problem.boundary[0].condition, Condition::potential);
  EXPECT_EQ(problem.boundary[0].value, 2);
  EXPECT_EQ(problem.electrolyte.valence, 1);
  EXPECT_EQ(problem.solver.quadrature, Quadrature::nodal);
  EXPECT_FALSE(problem.linear || problem.split || problem.manufactured || problem.plate);
}

TEST(ReadCase, LeavesTheTablesOfOtherToolsAlone) {
  EXPECT_NO_THROW(read_case("[mesh]\nshape = \"any\"\n[gas]\nx = 1\n[[surface]]\nname = \"a\"\n" + wall, "c"));
}

TEST(ReadCase, ScalesDimensionalInputWithTheDebyeLength) {
  const auto problem = read_case(
      "[electrolyte]\ndebye_length = 0.275e-6\n[lengths]\nunit = \"um\"\n"
      "[pair]\npatch = \"ball\"\nradius = 0.325\ndistance = 4.5\nheight = 2.5\n[plate]\npatch = \"wall\"\n"
      "[boundary.ball]\nkind = \"potential\"\nvalue = 77.0778\nunit = \"mV\"\n" +
          wall,
      "case.toml");

  ASSERT_EQ(problem.spheres.size(), 2U);
  EXPECT_NEAR(problem.spheres[0].radius, 1.1818182, 1e-7);
  EXPECT_NEAR(2 * problem.spheres[0].center.x, 16.363636, 1e-6);
  EXPECT_NEAR(problem.spheres[0].center.z, 9.0909091, 1e-7);
  EXPECT_EQ(problem.spheres[1].center.x, -problem.spheres[0].center.x);
  EXPECT_TRUE(problem.spheres[1].patch.empty());
  EXPECT_NEAR(problem.find_boundary("ball")->value, 3, 1e-4);
  EXPECT_EQ(problem.plate->potential, 2);
}

TEST(ReadCase, RefusesLengthsThatNoMeshHas) {
  const auto refusal = [](const std::string& tables) { return error_of(tables + wall + sphere_boundary); };
  const auto pair = [](const std::string& keys) { return "[pair]\npatch = \"ball\"\n" + keys; };

  EXPECT_THAT(refusal(pair("radius = 1\ndistance = 1e308\n")),
              testing::AllOf(testing::HasSubstr("case.toml:4:"), testing::HasSubstr("distance")));
  EXPECT_THAT(refusal(pair("radius = 1\ndistance = 3\nheight = -1e13\n")), testing::HasSubstr("at most 1e+12"));
  EXPECT_THAT(refusal(pair("radius = 1e-320\ndistance = 3\n")), testing::HasSubstr("at least 1e-12"));
  EXPECT_THAT(refusal("[electrolyte]\ndebye_length = 1e-7\n[lengths]\nunit = \"m\"\n"
                      "[[sphere]]\npatch = \"ball\"\ncenter = [0, 1e302, 0]\nradius = 1e-7\n"),
              testing::HasSubstr("center"));
  EXPECT_THAT(refusal("[plate]\npatch = \"wall\"\nposition = 1e200\n"), testing::HasSubstr("position"));
  EXPECT_THAT(refusal("[force]\nouter = 1e300\n"), testing::HasSubstr("outer"));
}

TEST(ReadCase, NamesTheLineOfAnUnknownKey) {
  EXPECT_THAT(error_of("[solver]\ntolerance = 1e-8\nspeed = 3\n" + wall),
              testing::AllOf(testing::HasSubstr("case.toml:3:1: unknown key 'speed' in [solver]"),
                             testing::HasSubstr("tolerance")));
  EXPECT_THAT(error_of("[weather]\nsun = true\n" + wall), testing::HasSubstr("case.toml:1:2: unknown key 'weather'"));
  EXPECT_THAT(error_of(wall + "flux = 2\n"),
              testing::HasSubstr("case.toml:4:1: unknown key 'flux' in [boundary.wall]"));
}

TEST(ReadCase, NamesTheKeyThatAMisspelledOneWasMeantToBe) {
  EXPECT_EQ(error_of("[[sphere]]\npatch = \"ball\"\ncentre = [0, 0, 0]\nradius = 1\n" + wall + sphere_boundary),
            "case.toml:3:1: unknown key 'centre' in [[sphere]]; did you mean 'center'?");
  EXPECT_EQ(error_of("[solver]\ntolerence = 1e-8\n" + wall),
            "case.toml:2:1: unknown key 'tolerence' in [solver]; did you mean 'tolerance'?");
}

TEST(ReadCase, TakesSaltsByTheChargesOfTheirIons) {
  EXPECT_THAT(error_of("[electrolyte]\nsalt = \"MgCl2\"\n" + wall),
              testing::AllOf(testing::HasSubstr("case.toml:2"), testing::HasSubstr("\"MgCl2\"")));
  EXPECT_TRUE(read_case("[electrolyte]\nsalt = \"1:1\"\n" + wall, "c").electrolyte.ions.empty());
  const auto magnesium = read_case("[electrolyte]\nsalt = \"2:1\"\nconcentration = 1\n" + wall, "c").electrolyte;
  ASSERT_EQ(magnesium.ions.size(), 2U);
  EXPECT_EQ(magnesium.ions[0].charge, 2);
  EXPECT_EQ(magnesium.ions[1].concentration, 2);
  // Three times the ionic strength of a 1:1 salt of that concentration.
  EXPECT_NEAR(*magnesium.debye_length, debye_length(Electrolyte{}, 3), 1e-18);
  EXPECT_EQ(read_case("[electrolyte]\nsalt = \"2:2\"\n" + wall, "c").electrolyte.valence, 2);
}

TEST(ReadCase, TakesMixturesOfIonsWithoutACharge) {
  const std::string sea =
      "[[electrolyte.ion]]\ncharge = 1\nconcentration = 3\n[[electrolyte.ion]]\ncharge = 2\n"
      "concentration = 1\n[[electrolyte.ion]]\ncharge = -1\nconcentration = ";
  const auto mixed = read_case(sea + "5\n" + wall, "c").electrolyte;

  EXPECT_EQ(mixed.ions.size(), 3U);
  EXPECT_NEAR(*mixed.debye_length, debye_length(Electrolyte{}, 6), 1e-18);
  EXPECT_NEAR(*units_of(mixed).concentration, 1, 1e-12);
  EXPECT_THAT(error_of(sea + "4\n" + wall), testing::HasSubstr("charges add up to 0"));
  EXPECT_THAT(error_of("[electrolyte]\ndebye_length = 1e-6\n" + sea + "5\n" + wall),
              testing::HasSubstr("Debye length"));
  EXPECT_THAT(error_of("[electrolyte]\nsalt = \"1:1\"\n" + sea + "5\n" + wall), testing::HasSubstr("both"));
  EXPECT_THAT(error_of(sea + "5\n[plate]\npatch = \"wall\"\n" + wall), testing::HasSubstr("its profile"));
}

TEST(ReadCase, RefusesSpheresThatOverlapOrTouchThePlate) {
  const std::string touching =
      "[plate]\npatch = \"wall\"\n[[sphere]]\npatch = \"ball\"\ncenter = [0, 0, 1]\nradius = 1\n";
  const std::string pair = "[pair]\npatch = \"ball\"\nradius = 1\ndistance = 1.9\n";

  EXPECT_THAT(error_of(touching + wall + sphere_boundary), testing::HasSubstr("touch"));
  EXPECT_THAT(error_of(pair + sphere_boundary), testing::HasSubstr("overlap"));
}

TEST(ReadCase, RefusesContradictoryLengths) {
  EXPECT_THAT(error_of("[electrolyte]\ndebye_length = 1e-8\nconcentration = 10\n" + wall),
              testing::HasSubstr("debye_length"));
  EXPECT_THAT(error_of("[lengths]\nunit = \"nm\"\n" + wall), testing::HasSubstr("debye_length"));
  EXPECT_THAT(error_of("[force]\ninner = 2\nouter = 1\n" + wall), testing::HasSubstr("inner"));
}

TEST(ReadCase, RefusesWhatDrivesNothing) {
  EXPECT_THAT(error_of("[boundary.wall]\nkind = \"symmetry\"\n"), testing::HasSubstr("given potential or charge"));
  EXPECT_THAT(error_of("[boundary.wall]\nkind = \"charge\"\nvalue = 0\n"),
              testing::HasSubstr("given potential or charge"));
  EXPECT_THAT(error_of(""), testing::HasSubstr("[boundary.PATCH]"));
}

TEST(ReadCase, ReadsTheOldNameOfKind) {
  const std::string old = "[boundary.wall]\ncondition = \"potential\"\nvalue = 2\n";
  EXPECT_EQ(read_case(old, "c").boundary.at(0).value, read_case(wall, "c").boundary.at(0).value);
  EXPECT_EQ(read_case(old, "c").boundary.at(0).condition, Condition::potential);
  EXPECT_THAT(error_of(old + "kind = \"potential\"\n"), testing::HasSubstr("either kind or its old name condition"));
  EXPECT_EQ(error_of(wall + "walue = 1\n"),
            "case.toml:4:1: unknown key 'walue' in [boundary.wall]; did you mean 'value'?");
  EXPECT_EQ(error_of(wall + "sites = 1\n"),
            "case.toml:4:1: unknown key 'sites' in [boundary.wall]; expected one of kind, unit, value");
  EXPECT_THAT(error_of("[boundary.wall]\nkynd = \"potential\"\nvalue = 2\n"), testing::HasSubstr("kind"));
}

TEST(ReadCase, SaysThatAConditionTakesNoValue) {
  for (const std::string kind : {"symmetry", "plate-profile", "far-field", "manufactured"})
    for (const std::string key : {"value", "unit", "site", "pK"})
      EXPECT_EQ(error_of("[boundary.wall]\nkind = \"" + kind + "\"\n" + key + " = 1\n"),
                "case.toml:3:" + std::to_string(key.size() + 4) + ": expected no " + key +
                    " in [boundary.wall] with kind = \"" + kind + "\", found one");
}

TEST(ReadCase, RefusesValuesWhoseSquaresAreNoNumbers) {
  for (const std::string head : {"", "[equation]\nlinear = true\n"})
    for (const std::string kind : {"potential", "charge"})
      for (const std::string value : {"1e-51", "-1e-300", "1e51", "-1e300"})
        EXPECT_THAT(error_of(head + "[boundary.wall]\nkind = \"" + kind + "\"\nvalue = " + value + "\n"),
                    testing::HasSubstr("expected value = 0 or a number of size 1e-50 to 1e+50 in [boundary.wall]"));
  EXPECT_EQ(read_case("[boundary.wall]\nkind = \"potential\"\nvalue = 0\n", "c").boundary[0].value, 0);
}

TEST(ReadCase, NamesThePotentialOfAPlateThatHasAChargeOrSites) {
  const std::string plate = "[plate]\npatch = \"wall\"\n[electrolyte]\npH = 7\n[boundary.wall]\nkind = ";
  EXPECT_THAT(
      error_of(plate + "\"charge\"\nvalue = 2\n"),
      testing::AllOf(testing::HasSubstr("found \"charge\""), testing::HasSubstr("has 1.762747 kT/Ze: give it")));
  EXPECT_THAT(error_of(plate + "\"regulated\"\nsite = \"acid\"\nvalue = 2\npK = 5\n"),
              testing::AllOf(testing::HasSubstr("found \"regulated\""), testing::HasSubstr("has -1.689161 kT/Ze")));
  EXPECT_THAT(error_of(plate + "\"symmetry\"\n"), testing::EndsWith("found \"symmetry\""));
}

TEST(ReadCase, RefusesOtherBadInput) {
  for (const auto* text :
       {"[boundary.wall]\nkind = \"hot\"\n", "[boundary.wall]\nvalue = 2\n", "[boundary.wall]\nkind = \"potential\"\n",
        "[boundary.wall]\nkind = \"potential\"\nvalue = \"2\"\n", "[boundary]\nwall = 2\n", "boundary = [\n",
        "[boundary.wall]\nkind = \"potential\"\nvalue = nan\n", "[boundary.wall]\nkind = \"manufactured\"\n",
        "[boundary.wall]\nkind = \"charge\"\nvalue = 1\nunit = \"C/m2\"\n"})
    EXPECT_THROW(read_case(text, "c"), Error) << text;
  for (const auto* text :
       {"[equation]\nsplit = true\n", "[plate]\npatch = \"floor\"\n", "[estimator]\ngoal = \"midplane\"\n",
        "[estimator]\ngoal = \"charge\"\n", "[pair]\npatch = \"ball\"\nradius = 1\ndistance = 3\n",
        "[solver]\nquadrature = \"lobatto\"\n", "[solver]\nmax_newton = 0\n",
        "[[sphere]]\ncenter = [0, 0]\nradius = 1\n", "[[sphere]]\ncenter = [0, 0, 0]\nradius = -1\n", "sphere = 3\n",
        "[equation]\nlinear = 1\n"})
    EXPECT_THROW(read_case(text + wall, "c"), Error) << text;
}

TEST(DescribeCase, PrintsBothScales) {
  const auto lines = describe(
      read_case("[electrolyte]\ndebye_length = 0.275e-6\n[[sphere]]\npatch = \"ball\"\ncenter = [0, 0, 0]\nradius = "
                "1.1818182\n" +
                    sphere_boundary,
                "c"));

  EXPECT_THAT(lines, testing::Contains(testing::HasSubstr("4.58811e-13 N")));
  EXPECT_THAT(lines, testing::Contains(testing::HasSubstr("1.181818 (3.25e-07 m)")));
  EXPECT_THAT(lines, testing::Contains(testing::HasSubstr("patch ball: potential 3 (0.0770777 V)")));
}

TEST(ReadCase, RefusesPotentialsWhoseLayerNoMeshCanHold) {
  const std::string high = "[boundary.wall]\nkind = \"potential\"\nvalue = 51\n";
  EXPECT_THAT(error_of(high), testing::AllOf(testing::HasSubstr("at most 50 kT/Ze"), testing::HasSubstr("51 kT/Ze")));
  EXPECT_EQ(error_of("[equation]\nlinear = true\n" + high), "no error");
  EXPECT_EQ(error_of("[boundary.wall]\nkind = \"potential\"\nvalue = -50\n"), "no error");
  EXPECT_THAT(error_of("[boundary.wall]\nkind = \"charge\"\nvalue = 1e12\n"),
              testing::HasSubstr("a charge that makes a potential of at most 50"));
}

TEST(ReadCase, ReadsBodiesAndGoals) {
  const auto problem = read_case(
      "[[body]]\nname = \"scan\"\npatches = [\"ball\"]\ncenter = [1, 2, 3]\n[estimator]\n"
      "goals = [\"volume-x\", \"torque-y\", \"energy\"]\ngoal_patch = \"scan\"\n" +
          wall + sphere_boundary,
      "case.toml");

  ASSERT_EQ(problem.bodies.size(), 1U);
  EXPECT_EQ(problem.bodies[0].center->z, 3);
  ASSERT_EQ(problem.estimator.goals.size(), 3U);
  EXPECT_EQ(problem.estimator.goals[0].name, "force-x");
  EXPECT_EQ(problem.estimator.goals[1].kind, Goal::Kind::torque);
  EXPECT_EQ(problem.estimator.goals[1].axis, 1);
  EXPECT_EQ(problem.estimator.goals[2].body, "");
}

TEST(ReadCase, RefusesBodiesAndGoalsThatAreNone) {
  const std::string body = "[[body]]\nname = \"scan\"\npatches = [\"ball\"]\n";
  EXPECT_THAT(error_of("[[body]]\nname = \"wall\"\npatches = [\"ball\"]\n" + wall + sphere_boundary),
              testing::HasSubstr("no patch's"));
  EXPECT_THAT(error_of(body + wall), testing::HasSubstr("\"ball\""));
  EXPECT_THAT(error_of(body + body + wall + sphere_boundary), testing::HasSubstr("another name"));
  for (const std::string goal : {"force", "force-w", "charge-x", "drag"})
    EXPECT_THAT(error_of("[estimator]\ngoal = \"" + goal + "\"\ngoal_patch = \"wall\"\n" + wall),
                testing::HasSubstr("\"torque-z\""));
  EXPECT_THAT(error_of("[estimator]\ngoal = \"force-x\"\n" + wall), testing::HasSubstr("goal_patch"));
  EXPECT_THAT(error_of("[force]\nouter = 1\n" + wall), testing::HasSubstr("[[sphere]]"));
}

}  // namespace pb_case_test
}  // namespace pamr::poisson_boltzmann
