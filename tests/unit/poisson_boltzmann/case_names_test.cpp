// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/problem/case_names.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pamr/base/error.hpp"

namespace pamr::poisson_boltzmann {
namespace case_names_test {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::vector<mesh::Patch> patches{{"body_1", ""}, {"body_2", ""}, {"far", ""}, {"plate", ""}};

std::string condition(const std::string& patch, const std::string& kind, const std::string& value = "") {
  return "[boundary.\"" + patch + "\"]\nkind = \"" + kind + "\"\n" + (value.empty() ? "" : "value = " + value + "\n");
}

Case resolved(const std::string& text) { return resolve_names(read_case(text, "case.toml"), patches, "case.toml"); }

std::string error_of(const std::string& text) {
  try {
    resolved(text);
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(ResolveNames, PutsPatchesInThePlaceOfPatterns) {
  const auto input =
      resolved("[[body]]\nname = \"body\"\npatches = [\"*\"]\n" + condition("body_*", "charge", "2") +
               condition("*", "symmetry") + condition("far", "far-field") + condition("plate", "symmetry"));
  ASSERT_EQ(input.boundary.size(), 4U);
  for (const auto* name : {"body_1", "body_2"}) {
    EXPECT_EQ(input.find_boundary(name)->condition, Condition::charge) << name;
    EXPECT_EQ(input.find_boundary(name)->value, 2) << name;
  }
  EXPECT_EQ(input.find_boundary("far")->condition, Condition::far_field);
  EXPECT_EQ(input.find_boundary("plate")->condition, Condition::symmetry);
  EXPECT_EQ(input.find_boundary("other"), nullptr);
  EXPECT_THAT(input.bodies.at(0).patches, ElementsAre("body_1", "body_2"));
}

TEST(ResolveNames, LeavesNamesAsTheyAre) {
  const auto input = resolved("[[body]]\nname = \"both\"\npatches = [\"body_2\", \"body_?\"]\n" +
                              condition("far", "symmetry") + condition("body_2", "potential", "1") +
                              condition("body_1", "potential", "3") + condition("plate", "symmetry"));
  std::vector<std::string> names;
  for (const auto& b : input.boundary) names.push_back(b.patch);
  EXPECT_THAT(names, ElementsAre("body_1", "body_2", "far", "plate"));  // as the case file is read: by name
  EXPECT_THAT(input.bodies.at(0).patches, ElementsAre("body_2", "body_1"));
}

TEST(ResolveNames, FindsTheConditionOfASphereBeforeTheMeshIsKnown) {
  const auto text = "[[sphere]]\npatch = \"body_1\"\ncenter = [0, 0, 0]\nradius = 1\n" +
                    condition("body*", "potential", "1") + condition("far", "far-field") +
                    condition("plate", "symmetry");
  EXPECT_NO_THROW(resolved(text));
}

TEST(ResolveNames, PutsAllItsPatchesInThePlaceOfAGroup) {
  auto grouped = patches;
  grouped[0].groups = {{1, "left"}, {2, "spheres"}};
  grouped[1].groups = {{2, "spheres"}, {3, "right"}};
  const auto of = [&](const std::string& text) { return resolve_names(read_case(text, "c"), grouped, "c"); };
  const auto rest = condition("*", "symmetry");
  const auto input =
      of("[[body]]\nname = \"pair\"\npatches = [\"spheres\"]\n" + condition("spheres", "charge", "2") + rest);
  for (const auto* name : {"body_1", "body_2"}) EXPECT_EQ(input.find_boundary(name)->condition, Condition::charge);
  EXPECT_EQ(input.find_boundary("far")->condition, Condition::symmetry);
  EXPECT_THAT(input.bodies.at(0).patches, ElementsAre("body_1", "body_2"));
  const auto own = of(condition("spheres", "charge", "2") + condition("body_2", "symmetry") + rest);
  EXPECT_EQ(own.find_boundary("body_2")->condition, Condition::symmetry);
  try {
    of(condition("spheres", "charge", "2") + condition("left", "symmetry") + rest);
    FAIL() << "was accepted";
  } catch (const Error& error) {
    EXPECT_THAT(error.what(),
                HasSubstr("expected one name that stands for \"body_1\", found \"left\" and \"spheres\""));
  }
}

TEST(ResolveNames, RefusesWhatIsAmbiguousOrStandsForNothing) {
  const auto walls =
      condition("body_*", "potential", "1") + condition("far", "symmetry") + condition("plate", "symmetry");
  EXPECT_THAT(error_of(walls + condition("*_1", "symmetry")),
              HasSubstr("expected one name that stands for \"body_1\", found \"*_1\" and \"body_*\""));
  EXPECT_THAT(error_of("[[body]]\nname = \"b\"\npatches = [\"p*\"]\n" + walls),
              HasSubstr("found none that \"p*\" stands for"));
  EXPECT_THAT(error_of("[[body]]\nname = \"far\"\npatches = [\"body*\"]\n" + walls), HasSubstr("found \"far\""));
  EXPECT_THAT(error_of("[[body]]\nname = \"body_2\"\npatches = [\"body_*\"]\n" + walls), HasSubstr("found \"body_2\""));
}

}  // namespace case_names_test
}  // namespace pamr::poisson_boltzmann
