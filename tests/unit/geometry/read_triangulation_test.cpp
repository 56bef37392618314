// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/read_triangulation.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <string>
#include <tuple>
#include <vector>

#include "pamr/base/counted.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/surface_toml.hpp"
#include "pamr/geometry/triangulated/self_intersection.hpp"
#include "pamr/geometry/triangulated/triangulated_surface.hpp"
#include "support/triangulations.hpp"

namespace pamr::geometry {
namespace read_triangulation_test {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// The error of reading bytes as a file of that name; empty when there is none.
std::string error_of(const std::string& bytes, const std::string& name, bool open_allowed = false) {
  try {
    parse_triangulation(bytes, name, open_allowed);
  } catch (const Error& error) {
    return error.what();
  }
  return "";
}

std::string replaced(std::string text, const std::string& what, const std::string& by) {
  const auto place = text.find(what);
  return place == std::string::npos ? "" : text.replace(place, what.size(), by);
}

const std::string tetrahedron = "OFF\n4 4 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n";

TEST(SurfaceFile, ReadsTheSameSurfaceFromEveryFormat) {
  const auto sphere = ::pamr::testing::icosphere(1);

  EXPECT_EQ(parse_triangulation(::pamr::testing::as_off(sphere), "a.off"), sphere);
  EXPECT_EQ(parse_triangulation(::pamr::testing::as_obj(sphere), "a.OBJ"), sphere);
  EXPECT_EQ(parse_triangulation(::pamr::testing::as_ply_text(sphere), "a.ply"), sphere);
  EXPECT_EQ(parse_triangulation(::pamr::testing::as_ply_bytes(sphere), "a.ply"), sphere);
  for (const auto& bytes : {::pamr::testing::as_stl_text(sphere), ::pamr::testing::as_stl_bytes(sphere)}) {
    const auto read = parse_triangulation(bytes, "a.stl");
    ASSERT_EQ(read.points.size(), sphere.points.size());
    ASSERT_EQ(read.triangles.size(), sphere.triangles.size());
    for (std::size_t t = 0; t < read.triangles.size(); ++t)
      for (std::size_t k = 0; k < 3; ++k)
        EXPECT_LT(norm(read.points[static_cast<std::size_t>(read.triangles[t][k])] -
                       sphere.points[static_cast<std::size_t>(sphere.triangles[t][k])]),
                  1e-7);
  }
}

TEST(SurfaceFile, ReadsPlyOfTheOtherByteOrderWithMoreProperties) {
  std::string bytes =
      "ply\nformat binary_big_endian 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "property uchar red\nelement face 4\nproperty list uchar ushort vertex_index\nend_header\n";
  const auto add = [&](const void* value, std::size_t size) {
    const char* first = static_cast<const char*>(value);
    bytes.append(std::make_reverse_iterator(first + size), std::make_reverse_iterator(first));
  };
  const float points[4][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (const auto& p : points) {
    for (const float x : p) add(&x, sizeof x);
    bytes += '\x7f';
  }
  const std::uint16_t triangles[4][3] = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  for (const auto& t : triangles) {
    bytes += '\3';
    for (const auto p : t) add(&p, sizeof p);
  }

  auto read = parse_triangulation(bytes, "a.ply");
  EXPECT_EQ(read.remarks.size(), 1U);
  read.remarks.clear();
  EXPECT_EQ(read, parse_triangulation(tetrahedron, "a.off"));
}

double volume_of(const Triangulation& surface) {
  double sum = 0;
  for (const auto& [a, b, c] : surface.triangles) {
    const auto p = [&](int i) { return surface.points[static_cast<std::size_t>(i)]; };
    sum += dot(p(a), cross(p(b), p(c))) / 6;
  }
  return sum;
}

TEST(SurfaceFile, SplitsFacesOfFourCornersAndMore) {
  // A prism over an L of six corners, which no fan from its first corner fills, and its six sides.
  const double x[] = {1, 2, 2, 0, 0, 1}, y[] = {1, 1, 2, 2, 0, 0};
  std::string obj, off = "OFF\n12 8 0\n", faces_obj = "f 6 5 4 3 2 1\nf 7 8 9 10 11 12\n",
                   faces = "6 5 4 3 2 1 0\n6 6 7 8 9 10 11\n";
  for (const int z : {0, 1})
    for (std::size_t i = 0; i < 6; ++i) {
      const auto point = std::to_string(x[i]) + " " + std::to_string(y[i]) + " " + std::to_string(z) + "\n";
      obj += "v " + point;
      off += point;
    }
  for (int i = 0; i < 6; ++i) {
    const int j = (i + 1) % 6;
    faces += fmt::format("4 {} {} {} {}\n", i, j, 6 + j, 6 + i);
    faces_obj += fmt::format("f {} {} {} {}\n", i + 1, j + 1, 7 + j, 7 + i);
  }
  const auto ply =
      "ply\nformat ascii 1.0\nelement vertex 12\nproperty double x\nproperty double y\nproperty double z\n"
      "element face 8\nproperty list uchar int vertex_indices\nend_header\n" +
      off.substr(off.find('\n', 4) + 1) + faces;
  const auto surface = parse_triangulation(off + faces, "a.off");

  EXPECT_EQ(surface.triangles.size(), 2U * 4 + 6 * 2);
  EXPECT_DOUBLE_EQ(volume_of(surface), 3);
  for (const auto& [a, b, c] : surface.triangles) EXPECT_TRUE(a != b && b != c && c != a);
  EXPECT_EQ(find_self_intersections(surface).n_pairs, 0);
  EXPECT_EQ(parse_triangulation(obj + faces_obj, "a.obj"), surface);
  EXPECT_EQ(parse_triangulation(ply, "a.ply"), surface);
  EXPECT_THAT(error_of(obj + "f 1 2\n", "a.obj"), HasSubstr("a.obj:13: "));
  EXPECT_THAT(error_of(replaced(off + faces, "4 0 1 7 6", "2 0 1"), "a.off"), HasSubstr("from 3 to 1000"));
  EXPECT_THAT(error_of(replaced(ply, "4 0 1 7 6", "2 0 1"), "a.ply"), HasSubstr("3 to 1000 corners"));
}

TEST(SurfaceFile, SplitsAQuadThatIsNotConvexInside) {
  const auto dart = parse_soup("OFF\n4 1 0\n0 0 0\n4 0 0\n1 1 0\n0 4 0\n4 0 1 2 3\n", "a.off");

  EXPECT_THAT(dart.triangles, ::testing::SizeIs(2));
  for (const auto& [a, b, c] : dart.triangles) {
    const auto p = [&](int i) { return dart.points[static_cast<std::size_t>(i)]; };
    EXPECT_GT(cross(p(b) - p(a), p(c) - p(a)).z, 0);
  }
}

TEST(SurfaceFile, ReadsStlWithoutNormalsAndNamesItsSolids) {
  const auto text = ::pamr::testing::as_stl_text(::pamr::testing::icosphere(0));
  const auto read = parse_triangulation(text, "a.stl");
  std::string none, short_ones;
  for (std::size_t at = 0; at < text.size();) {
    const auto end = text.find('\n', at);
    const auto line = text.substr(at, end - at);
    const bool is_facet = line.find("facet normal") != std::string::npos;
    none += (is_facet ? "facet" : line) + "\n";
    short_ones += (is_facet ? "facet normal 0 1" : line) + "\n";
    at = end + 1;
  }

  EXPECT_EQ(parse_triangulation(none, "a.stl"), read);
  EXPECT_EQ(parse_triangulation(short_ones, "a.stl"), read);
  EXPECT_THAT(error_of(replaced(text, "outer loop", "0 0 loop"), "a.stl"), HasSubstr("expected \"outer\""));
  EXPECT_EQ(read.remarks, std::vector<std::string>());
  EXPECT_THAT(parse_soup("solid in  let\nendsolid\nsolid\nendsolid\n", "a.stl").remarks,
              ElementsAre("left out: the names of 2 solids (\"in let\", \"\"), which are one surface"));
}

TEST(SurfaceFile, ReadsWhatEditorsAndTransfersPutAroundStl) {
  const auto sphere = ::pamr::testing::icosphere(0);
  const auto text = ::pamr::testing::as_stl_text(sphere), bytes = ::pamr::testing::as_stl_bytes(sphere);
  const auto read = parse_triangulation(text, "a.stl"), from_bytes = parse_triangulation(bytes, "a.stl");
  const std::string mark = "\xef\xbb\xbf", zeros(512, '\0');

  for (const auto& odd :
       {mark + text, "\r\n\n  " + text, mark + "\n" + text, text + zeros, text + "\x1a", text + "\n\n"})
    EXPECT_EQ(parse_triangulation(odd, "a.stl"), read);
  EXPECT_EQ(parse_triangulation(mark + bytes, "a.stl"), from_bytes);
  for (const auto* behind : {"x", "color", "\n"}) {
    auto longer = parse_triangulation(bytes + behind, "a.stl");
    EXPECT_THAT(longer.remarks, ElementsAre(fmt::format("left out: {} behind the 20 triangles that the file announces",
                                                        counted(std::ssize(std::string(behind)), "byte", "bytes"))));
    longer.remarks.clear();
    EXPECT_EQ(longer, from_bytes);
  }
  EXPECT_THAT(error_of(text + "more\n", "a.stl"), HasSubstr("expected \"solid\""));
  EXPECT_THAT(error_of(std::string(84, '\0') + "more", "a.stl"), HasSubstr("50 for each triangle"));
  EXPECT_EQ(parse_triangulation(mark + tetrahedron, "a.off"), parse_triangulation(tetrahedron, "a.off"));
  EXPECT_EQ(parse_triangulation(mark + ::pamr::testing::as_obj(sphere), "a.obj"), sphere);
  EXPECT_EQ(parse_triangulation(mark + ::pamr::testing::as_ply_text(sphere), "a.ply"), sphere);
}

TEST(SurfaceFile, JoinsLinesOfObjThatEndInABackslash) {
  const std::string plain = "g lid\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  const auto read = parse_triangulation(plain, "a.obj");

  for (const auto* joint : {"\\\n", " \\\n ", "\\\r\n", "\\\n\\\n"}) {
    EXPECT_EQ(parse_triangulation(replaced(plain, "v 1 0 0", std::string("v 1 ") + joint + "0 0"), "a.obj"), read);
    EXPECT_EQ(parse_triangulation(replaced(plain, "f 1 3 2", std::string("f 1 3") + " " + joint + " 2"), "a.obj"),
              read);
    EXPECT_EQ(parse_triangulation(replaced(plain, "g lid", std::string("g ") + joint + "lid"), "a.obj"), read);
    EXPECT_EQ(parse_triangulation("s " + std::string(joint) + " 1\n" + plain, "a.obj"), read);
  }
  EXPECT_THAT(error_of(replaced(plain, "f 1 3 2", "f 1 \\\n3 x"), "a.obj"), HasSubstr("a.obj:7: "));
  EXPECT_THAT(error_of(replaced(plain, "v 1 0 0", "v 1 \\ 0 0"), "a.obj"), HasSubstr("a.obj:3: "));
  EXPECT_THAT(parse_triangulation("o a\n" + plain + "o a\n", "a.obj").remarks,
              ElementsAre("left out: the names of 2 groups (\"a\", \"lid\"), which are one surface"));
}

TEST(SurfaceFile, CountsWhatObjHasBesideItsShape) {
  const std::string plain = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n";
  const auto read = parse_triangulation(plain, "a.obj");
  ASSERT_EQ(read.remarks, std::vector<std::string>());

  for (const auto& [more, says] :
       {std::pair("vn 0 0 1\n", "1 normal"),
        std::pair("vt 0 1\nvt 1 1\nvn 0 0 1\nvn 1 0 0\nvn 0 1 0\n", "3 normals, 2 texture coordinates"),
        std::pair("g a\ng b\nvn 0 0 1\n", "the names of 2 groups (\"a\", \"b\"), which are one surface, 1 normal"),
        std::pair("mtllib a.mtl\nusemtl red\ns 1\nusemtl blue\n", "2 uses of materials"),
        std::pair("l 1 2\np 3\nvp .5\n", "1 parameter of a curve, 1 line, 1 single point")}) {
    auto with = parse_triangulation(plain + more, "a.obj");
    EXPECT_THAT(with.remarks, ElementsAre(std::string("left out: ") + says));
    with.remarks.clear();
    EXPECT_EQ(with, read);
  }
  EXPECT_THAT(parse_soup(replaced(plain, "v 0 0 1", "v 0 0 1 .5 .5 .5"), "a.obj").remarks,
              ElementsAre("left out: colors of 1 point"));
  EXPECT_EQ(parse_soup(replaced(plain, "v 0 0 1", "v 0 0 1 1"), "a.obj"), read);
}

TEST(SurfaceFile, CountsWhatPlyHasBesideItsShape) {
  const auto file = [](const std::string& of_points, const std::string& of_faces, const std::string& elements,
                       const std::string& values, const std::string& rest) {
    std::string text =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n" + of_points +
        "element face 4\nproperty list uchar int vertex_indices\n" + of_faces + elements + "end_header\n";
    for (const auto* point : {"0 0 0 ", "1 0 0 ", "0 1 0 ", "0 0 1 "}) text += point + values + "\n";
    for (const auto* face : {"3 0 2 1", "3 0 1 3", "3 0 3 2", "3 1 2 3"})
      text += std::string(face) + (of_faces.empty() ? "" : " 7") + "\n";
    return text + rest;
  };
  const auto read = parse_triangulation(file("", "", "", "", ""), "a.ply");
  ASSERT_EQ(read.remarks, std::vector<std::string>());

  for (const auto& [text, says] :
       {std::pair(file("property float nx\nproperty float ny\nproperty list uchar float s\n", "", "", "0 1 2 8 9", ""),
                  "nx, ny, s of 4 points"),
        std::pair(file("property uchar red\n", "property int part\n", "", "255", ""),
                  "red of 4 points, part of 4 faces"),
        std::pair(file("", "", "element edge 2\nproperty int a\nelement none 0\n", "", "0\n1\n"),
                  "2 elements 'edge'")}) {
    auto with = parse_triangulation(text, "a.ply");
    EXPECT_THAT(with.remarks, ElementsAre(std::string("left out: ") + says));
    with.remarks.clear();
    EXPECT_EQ(with, read);
  }
}

TEST(SurfaceFile, PassesOverNormalsColorsAndTextureCoordinatesOfOff) {
  const auto plain = parse_triangulation(tetrahedron, "a.off");
  const auto with = [](const std::string& first, const std::string& behind) {
    auto text = first + "\n4 4 0\n";
    for (const auto* point : {"0 0 0 ", "1 0 0 ", "0 1 0 ", "0 0 1 "}) text += point + behind + "\n";
    return text + tetrahedron.substr(tetrahedron.find("3 0 2 1"));
  };

  for (const auto& [first, behind, what] :
       {std::tuple("COFF", "1 0 0 1", "colors"), std::tuple("COFF", "255 0 0", "colors"),
        std::tuple("NOFF", "0 0 1", "normals"), std::tuple("CNOFF", "0 0 1 .5 .5 .5 1", "colors and normals"),
        std::tuple("STOFF", "0 1", "texture coordinates"),
        std::tuple("STCNOFF", "0 0 1 .5 .5 .5 1 0 1", "texture coordinates and colors and normals")}) {
    auto read = parse_triangulation(with(first, behind), "a.off");
    EXPECT_THAT(read.remarks, ElementsAre("left out: " + std::string(what) + " of 4 points")) << first;
    read.remarks.clear();
    EXPECT_EQ(read, plain) << first;
  }
  auto painted = parse_triangulation(replaced(tetrahedron, "3 0 2 1", "3 0 2 1 255 0 0"), "a.off");
  EXPECT_THAT(painted.remarks, ElementsAre("left out: colors of 1 face"));
  EXPECT_THAT(error_of(with("COFF", "1 0"), "a.off"), AllOf(HasSubstr("a.off:3: expected 3"), HasSubstr("found 2")));
  EXPECT_THAT(error_of(with("NOFF", "1 0 x"), "a.off"), HasSubstr("a.off:3: "));
  EXPECT_THAT(error_of(with("4OFF", "1"), "a.off"), HasSubstr("COFF, NOFF"));
}

TEST(SurfaceFile, RefusesSurfacesThatNoBodyHas) {
  EXPECT_EQ(error_of(tetrahedron, "a.off"), "");
  EXPECT_THAT(error_of(replaced(tetrahedron, "0 0 1", "0 0 nan"), "a.off"),
              AllOf(HasSubstr("a.off:6: "), HasSubstr("finite"), HasSubstr("nan")));
  EXPECT_THAT(error_of(replaced(tetrahedron, "3 1 2 3", "3 1 2 4"), "a.off"), HasSubstr("a.off:10: expected a whole"));
  EXPECT_THAT(error_of(replaced(tetrahedron, "3 1 2 3\n", ""), "a.off"), HasSubstr("end of the file"));
  EXPECT_THAT(error_of(tetrahedron + "3 1 2 3\n", "a.off"), HasSubstr("a.off:11: expected the end"));
  const auto open = replaced(replaced(tetrahedron, "3 1 2 3\n", ""), "4 4 0", "4 3 0");
  EXPECT_THAT(error_of(open, "a.off"), AllOf(HasSubstr("a.off: triangle 1: "), HasSubstr("(open)")));
  EXPECT_EQ(error_of(open, "a.off", true), "");
  EXPECT_THAT(error_of(replaced(tetrahedron, "3 1 2 3", "3 1 3 2"), "a.off"),
              AllOf(HasSubstr("triangle 4: "), HasSubstr("(orientation)")));
  EXPECT_THAT(error_of(replaced(tetrahedron, "3 1 2 3", "3 1 2 2"), "a.off"), HasSubstr("triangle 4: expected three"));
  EXPECT_THAT(error_of(replaced(tetrahedron, "0 0 1", "0.5 0.5 0"), "a.off"), HasSubstr("span an area"));
  EXPECT_THAT(error_of("OFF\n0 0 0\n", "a.off"), HasSubstr("(empty)"));
  EXPECT_THAT(error_of("", "a.off"), HasSubstr("a.off:1: expected \"OFF\""));
  EXPECT_THAT(error_of(tetrahedron, "a.vtk"), HasSubstr("ending in .stl, .obj, .ply or .off"));
}

TEST(SurfaceFile, RefusesSurfacesThatMeetThemselvesInAnEdgeOrAPoint) {
  const auto fin = "OFF\n5 5 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n3 1 2 3\n3 0 1 4\n";
  const auto two =
      "OFF\n7 8 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n-1 0 0\n0 -1 0\n0 0 -1\n3 0 2 1\n3 0 1 3\n3 0 3 2\n"
      "3 1 2 3\n3 0 4 5\n3 0 6 4\n3 0 5 6\n3 4 6 5\n";
  EXPECT_THAT(error_of(fin, "a.off", true), AllOf(HasSubstr("found 3"), HasSubstr("(non-manifold)")));
  EXPECT_THAT(error_of(two, "a.off"), AllOf(HasSubstr("point [0, 0, 0]"), HasSubstr("3 of 6 apart (non-manifold)")));
}

TEST(SurfaceFile, RefusesDamagedStl) {
  const auto sphere = ::pamr::testing::icosphere(0);
  const auto text = ::pamr::testing::as_stl_text(sphere);
  auto bytes = ::pamr::testing::as_stl_bytes(sphere);

  EXPECT_THAT(error_of(text.substr(0, text.find("endsolid")), "a.stl"), HasSubstr("end of the file"));
  EXPECT_THAT(error_of(replaced(text, "endloop", "vertex"), "a.stl"), HasSubstr("a.stl:7: expected \"endloop\""));
  EXPECT_THAT(error_of(bytes.substr(0, bytes.size() - 1), "a.stl"), HasSubstr("50 for each triangle"));
  const float infinity = INFINITY;
  std::memcpy(bytes.data() + 84 + 50 + 12, &infinity, sizeof infinity);
  EXPECT_THAT(error_of(bytes, "a.stl"), AllOf(HasSubstr("triangle 2: "), HasSubstr("infinity")));
}

TEST(SurfaceFile, RefusesTheSameFaultsInEveryFormat) {
  const auto good = ::pamr::testing::icosphere(0);
  auto empty = good, not_finite = good, flat = good, open = good, thick = good;
  empty.triangles.clear();
  not_finite.points[3].y = NAN;
  flat.points[5] = flat.points[11];  // two corners of triangle 1 in one place
  open.triangles.pop_back();
  thick.triangles.push_back({good.triangles[0][0], good.triangles[0][2], 7});
  const std::pair<const char*, std::string (*)(const Triangulation&)> formats[] = {
      {"a.stl", ::pamr::testing::as_stl_text},  {"a.stl", ::pamr::testing::as_stl_bytes},
      {"a.obj", ::pamr::testing::as_obj},       {"a.ply", ::pamr::testing::as_ply_text},
      {"a.ply", ::pamr::testing::as_ply_bytes}, {"a.off", ::pamr::testing::as_off}};
  for (const auto& [name, as_bytes] : formats) {
    const std::string bytes = as_bytes(good);
    EXPECT_EQ(error_of(bytes, name), "") << name;
    for (const auto& bad : {empty, not_finite, flat, open, thick})
      EXPECT_THAT(error_of(as_bytes(bad), name), HasSubstr(name)) << bad.triangles.size();
    EXPECT_THAT(error_of(as_bytes(open), name), HasSubstr("(open)"));
    EXPECT_THAT(error_of(as_bytes(thick), name), HasSubstr("(non-manifold)"));
    for (const std::size_t size : {std::size_t{0}, bytes.size() / 4, bytes.size() / 2, bytes.size() - 7})
      EXPECT_THAT(error_of(bytes.substr(0, size), name), HasSubstr(name)) << name << " cut at " << size;
  }
}

TEST(SurfaceFile, RefusesFilesThatAreNotThere) {
  EXPECT_THROW(read_triangulation("no/such/file.stl"), Error);
  EXPECT_THROW(read_triangulation(std::filesystem::temp_directory_path()), Error);
}

/// A folder of its own for files of a test, which it takes away.
class Folder {
 public:
  Folder() {
    std::string name = (std::filesystem::temp_directory_path() / "pamr-surface-XXXXXX").string();
    EXPECT_NE(mkdtemp(name.data()), nullptr);
    path_ = name;
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;
  Folder(Folder&&) = delete;
  Folder& operator=(Folder&&) = delete;

  std::filesystem::path write(const std::string& file, const std::string& text) const {
    std::ofstream(path_ / file) << text;
    return path_ / file;
  }

 private:
  std::filesystem::path path_;
};

/// A text STL of a tetrahedron, each face in a solid of that name.
std::string tetrahedron_of_solids(const std::array<std::string, 4>& names) {
  const std::array<std::string, 4> corner{"vertex 0 0 0\n", "vertex 1 0 0\n", "vertex 0 1 0\n", "vertex 0 0 1\n"};
  constexpr std::array<std::array<std::size_t, 3>, 4> faces{{{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}}};
  std::string text;
  for (std::size_t f = 0; f < 4; ++f) {
    const auto& [a, b, c] = faces[f];
    text += "solid " + names[f] + "\nfacet normal 0 0 0\nouter loop\n" + corner[a] + corner[b] + corner[c] +
            "endloop\nendfacet\nendsolid " + names[f] + "\n";
  }
  return text;
}

TEST(SurfaceFile, HasSolidsOfStlAndGroupsOfObjAsNamedParts) {
  const Folder folder;
  const auto named = [&](const std::string& file, const std::string& text) {
    return read_named_triangulation(folder.write(file, text));
  };

  const auto stl = named("a.stl", tetrahedron_of_solids({"in let", "wall", "in let", ""}));
  EXPECT_THAT(stl.parts.name, ElementsAre("in let", "wall", ""));
  EXPECT_THAT(stl.parts.part, ElementsAre(0, 1, 0, 2));
  EXPECT_EQ(stl.surface.remarks, std::vector<std::string>());
  const auto obj = named("a.obj",
                         "vn 0 0 1\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 1 1 0\nf 1 3 5 2\no side\nf 1 2 4\n"
                         "f 1 4 3\ng none\ng top\nf 2 5 4\nf 5 3 4\n");
  EXPECT_THAT(obj.parts.name, ElementsAre("", "side", "top"));
  EXPECT_THAT(obj.parts.part, ElementsAre(0, 0, 1, 1, 2, 2));
  EXPECT_THAT(obj.surface.remarks, ElementsAre("left out: 1 normal"));
  const auto file = folder.write("a.stl", tetrahedron_of_solids({"in let", "wall", "in let", ""}));
  const auto some = read_named_triangulation(file, false, [](const std::string& name) { return name == "wall"; });
  EXPECT_THAT(some.parts.name, ElementsAre("", "wall"));
  EXPECT_THAT(some.parts.part, ElementsAre(0, 1, 0, 0));
  EXPECT_THAT(some.surface.remarks, ElementsAre("left out: the name \"in let\""));
  const auto none = read_named_triangulation(file, false, nullptr);
  EXPECT_TRUE(none.parts.name.empty());
  EXPECT_THAT(none.surface.remarks, ElementsAre(HasSubstr("the names of")));
  const auto one = named("a.stl", tetrahedron_of_solids({"a", "a", "a", "a"}));
  EXPECT_TRUE(one.parts.name.empty());
  EXPECT_THAT(one.surface.remarks, ElementsAre(HasSubstr("the names of 4 solids")));
  EXPECT_TRUE(named("a.off", tetrahedron).parts.name.empty());
  EXPECT_TRUE(named("b.stl", ::pamr::testing::as_stl_bytes(::pamr::testing::icosphere(0))).parts.name.empty());
}

TEST(SurfaceFile, NamesPartsThatHaveFacesInCommon) {
  const Folder folder;
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 0 1\nv 0 0 -1\n";
  const std::string above = "f 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n", below = "f 1 2 3\nf 1 5 2\nf 1 3 5\nf 2 5 3\n";
  const auto read = [&](const std::string& text) { return read_named_triangulation(folder.write("a.obj", text)); };

  EXPECT_THAT([&] { read(points + "g above\n" + above + "g below\n" + below); },
              ::testing::ThrowsMessage<Error>(AllOf(HasSubstr("parts \"above\" and \"below\""), HasSubstr("found 4"))));
  EXPECT_THAT([&] { read(points + "g both\n" + above + below); },
              ::testing::ThrowsMessage<Error>(HasSubstr("non-manifold")));
}

TEST(SurfacesFromToml, KeepsTheBordersOfNamedPartsInItsText) {
  const Folder folder;
  folder.write("four.stl", tetrahedron_of_solids({"a", "b", "a", "b"}));
  const std::string text =
      "# [[surface]]\n[[surface]]\nname = \"ball\"\nkind = \"sphere\"\ncenter = [0, 0, 0]\nradius = 9\n [[ surface ]] "
      "# "
      "two\nname = \"body\"\nkind = \"triangulation\"\nfile = \"four.stl\"\nfeature_angle = 180\n";
  const auto where = folder.write("case.toml", text).string();
  const auto made = surfaces_of_case(parse_toml(text, where), where, [](const std::string&) { return true; });
  const auto read = surfaces_from_toml(made.toml, "mesh", made.triangulations);

  EXPECT_THAT(made.toml, HasSubstr("[[ surface ]] # two\nborder_edges = ["));
  EXPECT_TRUE(made.triangulations[0]->remarks.empty());
  const auto pieces = [](const SurfaceSet& set) {
    return dynamic_cast<const Triangulated&>(*set.find("body")).n_patches();
  };
  EXPECT_EQ(pieces(made), 2U);
  EXPECT_EQ(pieces(read), 2U);
  EXPECT_EQ(pieces(surfaces_of_case(parse_toml(text, where), where)), 1U);
  for (const auto* edges : {"[0]", "[0, 4]", "[-1, 0]", "[0, 0]"}) {
    const auto wrong = [&] { surfaces_from_toml(text + "border_edges = " + edges, "mesh", made.triangulations); };
    EXPECT_THAT(wrong, ::testing::ThrowsMessage<Error>(HasSubstr("border_edges"))) << edges;
  }
}

TEST(SurfacesFromToml, TakesTrianglesFromFilesBesideTheTextOrFromTheMesh) {
  std::string name = (std::filesystem::temp_directory_path() / "pamr-surface-XXXXXX").string();
  ASSERT_NE(mkdtemp(name.data()), nullptr);
  const std::filesystem::path folder = name;
  std::ofstream(folder / "ball.off") << ::pamr::testing::as_off(::pamr::testing::icosphere(2));
  const std::string text = "[[surface]]\nname = \"ball\"\nkind = \"triangulation\"\nfile = \"ball.off\"\n";

  const auto read = [&](const std::string& where) { return surfaces_of_case(parse_toml(text, where), where); };

  const auto from_files = read((folder / "case.toml").string());
  std::filesystem::remove_all(folder);
  const auto set = surfaces_from_toml(from_files.toml, "mesh", from_files.triangulations);

  ASSERT_EQ(set.triangulations.size(), 1U);
  EXPECT_EQ(set.triangulations[0]->name, "ball");
  EXPECT_NEAR(norm(set.find("ball")->project({2, 1, 0.5})), 1, 3e-4);
  EXPECT_EQ(set.find("ball")->project({2, 1, 0.5}), from_files.find("ball")->project({2, 1, 0.5}));
  const auto without = [&] { surfaces_from_toml(text, "mesh"); };
  EXPECT_THAT(without, ::testing::ThrowsMessage<Error>(AllOf(HasSubstr("mesh:1:1: "), HasSubstr("its triangles"))));
  EXPECT_THAT([&] { read("elsewhere/case.toml"); },
              ::testing::ThrowsMessage<Error>(AllOf(HasSubstr("elsewhere/case.toml:1:1: "), HasSubstr("ball.off"))));
}

}  // namespace read_triangulation_test
}  // namespace pamr::geometry
