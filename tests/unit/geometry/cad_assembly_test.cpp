// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <map>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/geometry/cad/cad_surface.hpp"
#include "pamr/geometry/cad/read_cad.hpp"

namespace pamr::geometry {
namespace cad_assembly_test {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;
using ::testing::ThrowsMessage;
using Regions = std::array<int, 2>;

/// data/assembly.step: a housing [0, 2]^3, a ball of radius 0.5 about its middle, and twice a peg [0, 1]^3, put at (2,
/// 0.5, 0.5), where it touches the housing, and at (5, 0, 0). The file is in millimeters but for the peg, which is in
/// centimeters. The peg is green, its face at x = 1 is called tip.
std::string assembly(const std::string& old_words = {}, const std::string& new_words = {}) {
  auto text = read_cad_source(std::string(PAMR_TEST_DATA) + "/assembly.step").text;
  if (!old_words.empty()) {
    const auto place = text.find(old_words);
    EXPECT_NE(place, std::string::npos);
    text.replace(place, old_words.size(), new_words);
  }
  return text;
}

std::string with_peg_at(const std::string& x) { return assembly("(2.,0.5,0.5)", "(" + x + ",0.5,0.5)"); }

/// `text` with the ball about another middle: its lowest point is a vertex, its seam lies where x is largest.
std::string with_ball_at(std::string text, Vec3 middle, double radius = 0.5) {
  const auto replace = [&text](const std::string& old_words, const std::string& new_words) {
    const auto place = text.find(old_words);
    EXPECT_NE(place, std::string::npos);
    text.replace(place, old_words.size(), new_words);
  };
  replace("'',(1.,1.,0.5)", fmt::format("'',({:#g},{:#g},{:#g})", middle.x, middle.y, middle.z - radius));
  replace("'',(1.,1.,1.)", fmt::format("'',({:#g},{:#g},{:#g})", middle.x, middle.y, middle.z));
  replace("'',#218,0.5)", fmt::format("'',#218,{:#g})", radius));
  return text;
}

int count(const CadAssembly& made, Regions regions) {
  return static_cast<int>(
      std::count_if(made.face.begin(), made.face.end(), [&](const auto& face) { return face.region == regions; }));
}

TEST(CadAssembly, PartsAreRegionsThatShareTheFacesBetweenThem) {
  const auto made = assemble_cad(assembly(), 1);

  EXPECT_THAT(made.region, ElementsAre("housing", "ball", "peg_1", "peg_2"));
  EXPECT_THAT(made.region_of_solid, ElementsAre(0, 1, 2, 3));
  EXPECT_TRUE(made.loose_face.empty());
  EXPECT_EQ(made.face.size(), 19U);
  EXPECT_EQ(count(made, {0, -1}), 6);
  EXPECT_EQ(count(made, {0, 1}), 1);
  EXPECT_EQ(count(made, {0, 2}), 1);
  EXPECT_EQ(count(made, {2, -1}), 5);
  EXPECT_EQ(count(made, {3, -1}), 6);
}

TEST(CadAssembly, FacesKeepNamesColorsAndNumbersAtEachPlaceOfAPart) {
  const auto made = assemble_cad(assembly(), 1);

  for (const int peg : {2, 3}) {
    int n_tips = 0;
    for (const auto& face : made.face) {
      if (face.region != Regions{peg, -1}) continue;
      EXPECT_EQ(face.color, "#00ff00");
      n_tips += face.name == "tip";
    }
    EXPECT_EQ(n_tips, 1) << peg;
  }
  std::set<int> numbers;
  for (const auto& face : made.face)
    if (face.region == Regions{0, -1}) {
      numbers.insert(face.number);
      EXPECT_EQ(face.color + face.name, "");
    }
  EXPECT_THAT(numbers, ElementsAre(1, 2, 3, 4, 5, 6));  // one of them without what the peg covers
}

TEST(CadAssembly, ItsTextIsAShapeWithTheseFaces) {
  const auto made = assemble_cad(assembly(), 1);
  const auto measures = measure_cad(made.text, 1);
  const auto solids = triangulate_cad(made.text, 1, 1e-3, true).solids;

  ASSERT_EQ(measures.area.size(), made.face.size());
  std::map<Regions, double> area;
  for (std::size_t f = 0; f < made.face.size(); ++f) area[made.face[f].region] += measures.area[f];
  EXPECT_NEAR((area[{0, 1}]), std::numbers::pi, 1e-7);
  EXPECT_NEAR((area[{0, 2}]), 1, 1e-9);
  EXPECT_NEAR((area[{0, -1}]), 23, 1e-9);
  ASSERT_EQ(solids.solid.size(), 4U);
  const double ball = std::numbers::pi / 6;
  EXPECT_NEAR(solids.solid[0].volume, 8 - ball, 1e-3);
  EXPECT_NEAR(solids.solid[1].volume, ball, 1e-3);
  EXPECT_NEAR(solids.solid[2].volume, 1, 1e-9);
  EXPECT_EQ(solids.solid[1].sides.size(), 1U);
  EXPECT_TRUE(solids.solid[1].sides[0].is_flipped);  // the housing has the ball's face first
  const auto model = make_cad_model({"a.brep", made.text}, "cm", true);
  EXPECT_EQ(model->n_solids(), 4);
  EXPECT_EQ(model->faces().size(), 19U);
  EXPECT_NEAR(model->magnitude(), 0.6, 1e-9);
}

TEST(CadAssembly, TheSameTextGivesTheSameBits) {
  const auto first = assemble_cad(assembly(), 1), again = assemble_cad(assembly(), 1);

  EXPECT_EQ(first.text, again.text);
}

TEST(CadAssembly, SolidsTouchWithinTheToleranceAndAreApartBeyondIt) {
  EXPECT_EQ(count(assemble_cad(with_peg_at("2.000002"), 1), {0, 2}), 1);
  EXPECT_EQ(count(assemble_cad(with_peg_at("1.999998"), 1), {0, 2}), 1);
  const auto apart = assemble_cad(with_peg_at("2.001"), 1);
  EXPECT_EQ(count(apart, {0, 2}), 0);
  EXPECT_EQ(apart.face.size(), 19U);
}

TEST(CadAssembly, NamesSolidsThatOverlap) {
  EXPECT_THAT([] { assemble_cad(with_peg_at("1.5"), 1); },
              ThrowsMessage<Error>(AllOf(HasSubstr("\"housing\" and \"peg_1\" overlap at [1.75, 1, 1]"))));
  EXPECT_THAT([] { assemble_cad(with_peg_at("1.5"), 2); }, ThrowsMessage<Error>(HasSubstr("[3.5, 2, 2]")));
  EXPECT_THAT([] { assemble_cad(assembly("(5.,0.,0.)", "(2.,0.5,0.5)"), 1); },
              ThrowsMessage<Error>(HasSubstr("\"peg_1\" and \"peg_2\" are the same solid")));
}

TEST(CadAssembly, NamesSolidsThatTouchAlongAnEdgeAlone) {
  EXPECT_THAT([] { assemble_cad(assembly("(5.,0.,0.)", "(3.,1.5,1.)"), 1); },
              ThrowsMessage<Error>(HasSubstr("\"peg_1\" and \"peg_2\" touch along an edge alone at [3, 1.5, 1.25]")));
  EXPECT_NO_THROW(assemble_cad(assembly("(5.,0.,0.)", "(3.,1.4,1.)"), 1));  // a face of 0.1 x 0.5
}

TEST(CadAssembly, NamesSolidsThatAreTangentInAPoint) {
  const auto error_with_ball_at = [](Vec3 middle) {
    return [text = with_ball_at(assembly(), middle)] { assemble_cad(text, 1); };
  };
  const auto names_ball_at = [](const std::string& place) {
    return ThrowsMessage<Error>(HasSubstr("\"housing\" and \"ball\" are tangent at [" + place));
  };

  EXPECT_THAT(error_with_ball_at({1, 1, 2.5}), names_ball_at("1, 1, 2]"));   // its lowest point, on a face
  EXPECT_THAT(error_with_ball_at({2, 1, 2.5}), names_ball_at("2, 1, 2]"));   // on an edge
  EXPECT_THAT(error_with_ball_at({2, 2, 2.5}), names_ball_at("2, 2, 2]"));   // on a corner
  EXPECT_THAT(error_with_ball_at({-0.5, 1, 1}), names_ball_at("0, 1, 1]"));  // its seam
  EXPECT_THAT(error_with_ball_at({1, 1, -0.5}), names_ball_at("1, 1, "));
  EXPECT_THAT(error_with_ball_at({1, -0.5, 1}), names_ball_at("1"));
  EXPECT_THAT(error_with_ball_at({1, 1, 1.5}), names_ball_at("1, 1, 2]"));  // from within
}

TEST(CadAssembly, TakesSolidsThatMeetInAPointAtAnAngle) {
  EXPECT_NO_THROW(assemble_cad(assembly("(5.,0.,0.)", "(3.,1.5,1.5)"), 1));  // two pegs corner to corner
  EXPECT_NO_THROW(assemble_cad(with_ball_at(assembly(), {1, 1, 2.501}), 1));
  const std::string flat = "(2.,0.5,0.5));\n#25 = DIRECTION('',(0.,0.,1.));\n#26 = DIRECTION('',(1.,0.,-0.))";
  const std::string upright =
      "(1.,1.,2.));\n#25 = DIRECTION('',(1.4142135623731,0.,1.));\n#26 = "
      "DIRECTION('',(-1.,1.7320508075689,1.4142135623731))";
  const auto on_corner = assemble_cad(assembly(flat, upright), 1);  // a peg that stands on a corner
  EXPECT_EQ(count(on_corner, {0, 2}), 0);
  EXPECT_EQ(count(on_corner, {2, -1}), 6);
}

TEST(CadAssembly, ThreeSurfacesOfTouchingSolidsHaveTheEdgeOfTheirFacesInCommon) {
  const auto made = assemble_cad(assembly(), 1);
  const auto model = make_cad_model({"a.brep", made.text}, "mm", true);
  std::array<std::vector<int>, 3> faces;  // of the housing beside the peg, of the peg, between the two
  for (std::size_t f = 0; f < made.face.size(); ++f) {
    const auto& face = made.face[f];
    if (face.region == Regions{0, -1} && face.number == 2) faces[0].push_back(static_cast<int>(f));
    if (face.region == Regions{2, -1}) faces[1].push_back(static_cast<int>(f));
    if (face.region == Regions{0, 2}) faces[2].push_back(static_cast<int>(f));
  }
  const CadSurface housing(model, faces[0]), peg(model, faces[1]), between(model, faces[2]);
  const std::array<const Surface*, 3> all{&housing, &peg, &between};

  const auto at_edge = project_onto_all(all, {2.05, 0.45, 0.9}), at_corner = project_onto_all(all, {2.05, 0.45, 0.4});

  EXPECT_LT(norm(at_edge.point - Vec3{2, 0.5, 0.9}), 1e-12);
  EXPECT_LT(norm(at_corner.point - Vec3{2, 0.5, 0.5}), 1e-12);
}

TEST(CadAssembly, OfNestedSolidsTheInnerOneWins) {
  const auto made = assemble_cad(with_ball_at(with_peg_at("0.5"), {1, 1, 1}, 0.4), 1);  // about the ball

  EXPECT_THAT(made.region, ElementsAre("housing", "ball", "peg_1", "peg_2"));
  const auto solids = triangulate_cad(made.text, 1, 1e-3, true).solids;
  double of_peg = 0;
  for (std::size_t s = 0; s < solids.solid.size(); ++s)
    if (made.region_of_solid[s] == 2) of_peg += solids.solid[s].volume;
  EXPECT_NEAR(of_peg, 1 - 4 * std::numbers::pi / 3 * 0.064, 1e-3);
}

TEST(CadAssembly, TakesChosenSolids) {
  const auto text = with_peg_at("1.5");
  const std::vector<std::string> pegs{"peg"}, two{"ball", "housing"}, one{"peg_2"}, none{"wheel"};

  EXPECT_THAT(assemble_cad(text, 1, pegs).region, ElementsAre("peg_1", "peg_2"));
  EXPECT_THAT(assemble_cad(text, 1, two).region, ElementsAre("housing", "ball"));
  const auto alone = assemble_cad(text, 1, one);
  EXPECT_THAT(alone.region, ElementsAre("peg_2"));
  EXPECT_EQ(alone.face.size(), 6U);
  EXPECT_GT(alone.face[0].number, 6);
  EXPECT_THAT([&] { assemble_cad(text, 1, none); },
              ThrowsMessage<Error>(HasSubstr("(housing, ball, peg_1, peg_2), found \"wheel\"")));
}

TEST(CadAssembly, SolidsWithoutANameAreNumbered) {
  const auto text = assembly("PRODUCT('ball', 'ball'", "PRODUCT('', ''");

  EXPECT_THAT(assemble_cad(text, 1).region, ElementsAre("housing", "solid_2", "peg_1", "peg_2"));
}

TEST(CadAssembly, RefusesWhatHasNoSolid) {
  auto text = read_cad_source(std::string(PAMR_TEST_DATA) + "/cube.step").text;
  const std::string solid = "MANIFOLD_SOLID_BREP('',#16)", shell = "SHELL_BASED_SURFACE_MODEL('',(#16))";
  ASSERT_NE(text.find(solid), std::string::npos);
  text.replace(text.find(solid), solid.size(), shell);

  EXPECT_THAT([&] { assemble_cad(text, 1); }, ThrowsMessage<Error>(HasSubstr("expected solids, found none")));
}

}  // namespace cad_assembly_test
}  // namespace pamr::geometry
