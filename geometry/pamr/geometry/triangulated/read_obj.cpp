// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/read_obj.hpp"

#include <array>
#include <limits>

#include "pamr/base/error.hpp"
#include "pamr/geometry/triangulated/polygons.hpp"
#include "pamr/geometry/triangulated/triangulation_text.hpp"

namespace pamr::geometry {

namespace {

constexpr std::int64_t most = std::numeric_limits<int>::max();

/// Statements of OBJ that say nothing about the shape.
bool says_no_shape(std::string_view word) {
  constexpr std::array<std::string_view, 13> known{"vn", "vt", "vp", "g",      "o",      "s",     "usemtl",
                                                   "l",  "p",  "mg", "mtllib", "maplib", "usemap"};
  for (const auto name : known)
    if (word == name) return true;
  return false;
}

/// "7", "7/1", "7/1/2" or "7//2"; negative numbers count from the last point.
int corner_of(const SurfaceText& text, std::string_view word, std::size_t n_points) {
  const auto n = static_cast<std::int64_t>(n_points);
  const auto number = text.whole_of(word.substr(0, word.find('/')), "point of a face", -n, n);
  if (number == 0) text.fail("expected points counted from 1 or from -1, found 0");
  return static_cast<int>(number > 0 ? number - 1 : n + number);
}

}  // namespace

Triangulation parse_obj(std::string_view bytes, const std::string& where) {
  Triangulation surface;
  Polygons faces;
  SurfaceText text(bytes, where, '#');
  while (!text.at_end()) {
    const auto word = text.word_in_line();
    if (word == "v") {
      std::array<double, 3> x{};
      for (double& value : x) value = text.number_of(text.word_in_line(), "coordinate");
      surface.points.push_back({x[0], x[1], x[2]});
    } else if (word == "f") {
      int n = 0;
      for (auto corner = text.word_in_line(); n < Polygons::min_corners || !corner.empty();
           corner = text.word_in_line()) {
        if (++n > Polygons::max_corners) text.fail("expected faces of up to 1000 corners, found one of more");
        faces.add_corner(corner_of(text, corner, surface.points.size()));
      }
      faces.end_face();
    } else if (!says_no_shape(word)) {
      text.fail("expected a statement of OBJ (v, f, vn, ...), found another");
    }
    text.skip_line();
  }
  faces.split(surface);
  return surface;
}

Triangulation parse_off(std::string_view bytes, const std::string& where) {
  Triangulation surface;
  SurfaceText text(bytes, where, '#');
  text.expect("OFF");
  const auto n_points = text.whole("number of points", 0, most);
  const auto n_faces = text.whole("number of faces", 0, most);
  text.whole("number of edges", 0, std::numeric_limits<std::int64_t>::max());
  for (std::int64_t i = 0; i < n_points; ++i) {
    const double x = text.number("x"), y = text.number("y"), z = text.number("z");
    surface.points.push_back({x, y, z});
  }
  Polygons faces;
  for (std::int64_t i = 0; i < n_faces; ++i) {
    const auto n = text.whole("corners of a face", Polygons::min_corners, Polygons::max_corners);
    for (std::int64_t k = 0; k < n; ++k)
      faces.add_corner(static_cast<int>(text.whole("point of a face", 0, n_points - 1)));
    faces.end_face();
    text.skip_line();  // a color may follow
  }
  faces.split(surface);
  if (!text.at_end()) text.fail("expected the end of the file after the last face, found more");
  return surface;
}

}  // namespace pamr::geometry
