// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/cad_source.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <string>

#include "pamr/base/error.hpp"
#include "pamr/geometry/cad/cad_surface.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/surface_toml.hpp"

namespace pamr::geometry {
namespace cad_source_test {

using ::testing::HasSubstr;
using ::testing::StartsWith;
using ::testing::ThrowsMessage;

const std::filesystem::path data = PAMR_TEST_DATA;

/// The cube [0, 1]^3, with other words in some places of its text.
CadSource cube(const std::string& old_words = {}, const std::string& new_words = {}) {
  auto source = read_cad_source(data / "cube.step");
  if (const auto place = source.text.find(old_words); !old_words.empty() && place != std::string::npos)
    source.text.replace(place, old_words.size(), new_words);
  return source;
}

std::string described(const CadSource& source, const std::string& keys) {
  return "[[surface]]\nname = \"side\"\nkind = \"cad\"\nfile = \"cube.step\"\n" + keys + "\n" + cad_table(source);
}

TEST(CadSource, TheTextTravelsVerbatimInTheDescription) {
  auto source = cube("'Unknown'", "'quotes \" and \\\\ and ''''''''\t'");
  source.text.insert(source.text.find('\n'), "\r");
  const auto set = surfaces_from_toml(described(source, "faces = [1]"), "test");
  const auto root = parse_toml(set.toml, "test");
  EXPECT_EQ(root.list("cad").at(0).text("text"), source.text);
  EXPECT_EQ(set.find("side")->project({0.3, 0.4, 0.5}), (Vec3{0, 0.4, 0.5}));
}

TEST(CadSource, ACaseAndItsDescriptionGiveTheSameSurface) {
  const auto folder = std::filesystem::temp_directory_path() / "pamr_cad_source_test";
  std::filesystem::create_directories(folder);
  std::filesystem::copy_file(data / "cube.step", folder / "cube.step",
                             std::filesystem::copy_options::overwrite_existing);
  const std::string text = "[[surface]]\nname = \"side\"\nkind = \"cad\"\nfile = \"cube.step\"\nfaces = [2]\n";
  const auto of_case = surfaces_of_case(parse_toml(text, "case.toml"), (folder / "case.toml").string());
  const auto again = surfaces_from_toml(of_case.toml, "mesh");
  EXPECT_EQ(again.toml, of_case.toml);
  EXPECT_EQ(again.find("side")->project({0.3, 0.4, 0.5}), of_case.find("side")->project({0.3, 0.4, 0.5}));
  EXPECT_TRUE(of_case.find("side")->is_flat());
  std::filesystem::remove_all(folder);
}

TEST(CadSource, SurfacesOfAModelAreThoseReadBackFromTheirDescription) {
  const auto source = cube();
  const auto model = make_cad_model(source, "mm");
  const std::array<CadPart, 2> parts{CadPart{"a \"side\"", {2}}, CadPart{"rest", {1, 3, 4}}};
  const auto made = cad_surfaces(source, "mm", model, parts, "test");

  const auto read = surfaces_from_toml(made.toml, "mesh");

  EXPECT_EQ(read.name, made.name);
  for (const Vec3 p : {Vec3{0.3, 0.4, 0.5}, Vec3{0.9, 0.2, 1.5}})
    for (int i = 0; i < made.size(); ++i) EXPECT_EQ(read.get(i)->project(p), made.get(i)->project(p)) << i;
  EXPECT_EQ(dynamic_cast<const CadSurface&>(*made.get(1)).shared_model(), model);
  EXPECT_TRUE(cad_surfaces(source, "mm", model, {}, "test").toml.empty());
}

TEST(CadSource, FacesAreFoundByName) {
  const auto source = cube("ADVANCED_FACE(''", "ADVANCED_FACE('inlet'");
  const auto set = surfaces_from_toml(described(source, "face_names = [\"inlet\"]"), "test");
  EXPECT_EQ(set.find("side")->project({0.3, 0.4, 0.5}), (Vec3{0, 0.4, 0.5}));
  EXPECT_THAT([&] { surfaces_from_toml(described(source, "face_names = [\"outlet\"]"), "test"); },
              ThrowsMessage<Error>(HasSubstr("found \"outlet\"")));
}

TEST(CadSource, CoordinatesAreInTheUnitThatIsAskedFor) {
  EXPECT_NEAR(make_cad_model(cube(), "m")->magnitude(), 1e-3, 1e-12);
  EXPECT_NEAR(make_cad_model(cube(), "in")->magnitude(), 1 / 25.4, 1e-12);
  const auto in_meters = make_cad_model(cube("SI_UNIT(.MILLI.,.METRE.)", "SI_UNIT($,.METRE.)"), "mm");
  EXPECT_NEAR(in_meters->magnitude(), 1000, 1e-9);
  EXPECT_EQ(in_meters->unit_of_file(), "metre");
  EXPECT_NEAR(measure_cad_source(cube(), "cm").volume, 1e-3, 1e-12);
}

TEST(CadSource, RefusesWhatIsNoShape) {
  const auto refusal = [](const CadSource& source, const std::string& part) {
    SCOPED_TRACE(source.text.substr(0, 60));
    EXPECT_THAT([&] { make_cad_model(source, "mm"); }, ThrowsMessage<Error>(HasSubstr(part)));
  };
  refusal({"cube.step", "solid cube"}, "file 'cube.step': expected a STEP text");
  refusal({"cube.step", cube().text.substr(0, 5000)}, "file 'cube.step': expected");
  refusal({"cube.step", "ISO-10303-21;\nHEADER;\nENDSEC;\nDATA;\nENDSEC;\nEND-ISO-10303-21;\n"}, "expected");
  refusal(cube("ADVANCED_FACE", "ADVANCED_FARCE"), "expected");
  refusal(cube("CARTESIAN_POINT('',(0.,0.,1.))", "CARTESIAN_POINT('',(0.,0.,7.))"),
          "expected");  // a vertex far from its edges
  EXPECT_NO_THROW(make_cad_model(cube(), "mm"));
}

TEST(CadSource, RefusesKeysThatAreWrong) {
  const auto refusal = [](const std::string& keys, const std::string& part) {
    EXPECT_THAT([&] { surfaces_from_toml(described(cube(), keys), "mesh.hdf"); },
                ThrowsMessage<Error>(HasSubstr(part)));
  };
  refusal("faces = [7]", "an array of integers between 1 and 6");
  refusal("faces = [2, 2]", "expected different ones, found 2 twice");
  refusal("faces = []", "expected one or more");
  refusal("unit = \"parsec\"", "mm, cm, m, um, in or ft");
  refusal("face = [1]", "unknown key 'face'");
  EXPECT_THAT([] { surfaces_from_toml("[[surface]]\nname = \"a\"\nkind = \"cad\"\nfile = \"b.step\"\n", "mesh.hdf"); },
              ThrowsMessage<Error>(HasSubstr("expected the text of its CAD file beside the description")));
  EXPECT_THAT(
      [] {
        surfaces_from_toml(described(cube(), "faces = [1]") + cad_table({"cube.step", "x"}), "mesh.hdf");
      },
      ThrowsMessage<Error>(HasSubstr("found two that differ")));
}

TEST(CadSource, RefusesEdgesThatAreNotOnTheirFace) {
  auto spool = read_cad_source(data / "spool.brep");
  EXPECT_NO_THROW(make_cad_model(spool, "mm"));
  const std::string good = "0.58800260354800005", wrong = "0.78800260354800005";
  const auto place = spool.text.find(good);  // of a control point of a spline face
  ASSERT_NE(place, std::string::npos);
  spool.text.replace(place, good.size(), wrong);

  EXPECT_THAT([&] { make_cad_model(spool, "mm"); },
              ThrowsMessage<Error>(HasSubstr("face 7: expected edges on the face")));
}

TEST(CadSource, RefusesFilesThatAreNoText) {
  EXPECT_THAT([] { read_cad_source("part.x_t"); }, ThrowsMessage<Error>(HasSubstr(".iges, .igs or .brep")));
  EXPECT_THAT([] { read_cad_source(data / "none.step"); }, ThrowsMessage<Error>(StartsWith("file '")));
  const auto file = std::filesystem::temp_directory_path() / "pamr_cad_source_test.step";
  std::ofstream(file) << "ISO-10303-21;\x01";
  EXPECT_THAT([&] { read_cad_source(file); }, ThrowsMessage<Error>(HasSubstr("found control characters")));
  std::ofstream(file) << "ISO-10303-21; /* Gr\xf6\xdf"
                         "e */";
  EXPECT_THAT(read_cad_source(file).text, HasSubstr("Gr\xc3\xb6\xc3\x9f"
                                                    "e"));
  std::filesystem::remove(file);
}

}  // namespace cad_source_test
}  // namespace pamr::geometry
