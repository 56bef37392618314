// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/read_obj.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "pamr/base/counted.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/triangulated/polygons.hpp"
#include "pamr/geometry/triangulated/triangulation_text.hpp"

namespace pamr::geometry {

namespace {

constexpr std::int64_t most = std::numeric_limits<int>::max();

/// Statements of OBJ that a surface has no place for.
class OtherStatements {
 public:
  /// Counts one; false for a word that is none of them.
  bool count(std::string_view word) {
    for (std::size_t i = 0; i < known.size(); ++i)
      if (word == known[i].word) return ++n_[i] > 0;
    return false;
  }
  /// Those that there are, but for those that only say how others are shown.
  void list(std::vector<std::string>& things) const {
    for (std::size_t i = 0; i < known.size(); ++i)
      if (n_[i] > 0 && !known[i].one.empty()) things.push_back(counted(n_[i], known[i].one, known[i].others));
  }

 private:
  struct Known {
    std::string_view word, one, others;
  };
  static constexpr std::array<Known, 11> known{{{"vn", "normal", "normals"},
                                                {"vt", "texture coordinate", "texture coordinates"},
                                                {"vp", "parameter of a curve", "parameters of curves"},
                                                {"l", "line", "lines"},
                                                {"p", "single point", "single points"},
                                                {"usemtl", "use of a material", "uses of materials"},
                                                {"s", "", ""},
                                                {"mg", "", ""},
                                                {"mtllib", "", ""},
                                                {"maplib", "", ""},
                                                {"usemap", "", ""}}};
  std::array<std::int64_t, known.size()> n_{};
};

/// "7", "7/1", "7/1/2" or "7//2"; negative numbers count from the last point.
int corner_of(const SurfaceText& text, std::string_view word, std::size_t n_points) {
  const auto n = static_cast<std::int64_t>(n_points);
  const auto number = text.whole_of(word.substr(0, word.find('/')), "point of a face", -n, n);
  if (number == 0) text.fail("expected points counted from 1 or from -1, found 0");
  return static_cast<int>(number > 0 ? number - 1 : n + number);
}

/// Numbers behind the coordinates of a point: how many there may be, and what they are.
struct Extra {
  std::string what;
  int min_numbers = 0, max_numbers = 0;
};

/// What the first word of an OFF file announces: "OFF", with letters before it for texture coordinates, colors and
/// normals. Source: Geomview manual, "OFF Files".
Extra extra_of(SurfaceText& text) {
  struct Part {
    std::string_view letters, name;
    int min_numbers, max_numbers;
  };
  constexpr std::array<Part, 3> parts{
      {{"ST", "texture coordinates", 2, 2}, {"C", "colors", 3, 4}, {"N", "normals", 3, 3}}};
  const auto word = text.word("\"OFF\"");
  auto rest = word;
  Extra extra;
  for (const auto& part : parts) {
    if (!is_same_word(rest.substr(0, part.letters.size()), part.letters)) continue;
    rest.remove_prefix(part.letters.size());
    extra.what += (extra.what.empty() ? "" : " and ") + std::string(part.name);
    extra.min_numbers += part.min_numbers;
    extra.max_numbers += part.max_numbers;
  }
  if (!is_same_word(rest, "OFF")) text.fail("expected \"OFF\" (or COFF, NOFF, STOFF, CNOFF, ...), found another word");
  return extra;
}

/// Passes the rest of a point's line.
void skip_numbers(SurfaceText& text, const Extra& extra) {
  int n = 0;
  for (auto word = text.word_in_line(); !word.empty(); word = text.word_in_line(), ++n)
    (void)text.number_of(word, "number of a point");
  if (n < extra.min_numbers || n > extra.max_numbers)
    text.fail(fmt::format("expected {} numbers behind the coordinates of a point, found {}", extra.min_numbers, n));
}

}  // namespace

NamedTriangulation parse_obj(std::string_view bytes, const std::string& where) {
  NamedTriangulation result;
  auto& surface = result.surface;
  Polygons faces;
  std::vector<std::string> groups;
  std::string group;
  OtherStatements others;
  std::int64_t n_colors = 0;
  SurfaceText text(bytes, where, '#');
  text.join_lines();
  while (!text.at_end()) {
    const auto word = text.word_in_line();
    if (word == "v") {
      std::array<double, 3> x{};
      for (double& value : x) value = text.number_of(text.word_in_line(), "coordinate");
      surface.points.push_back({x[0], x[1], x[2]});
      int n = 0;  // 1: a weight, 3 or 4: a color
      while (!text.word_in_line().empty()) ++n;
      if (n >= 3) ++n_colors;
    } else if (word == "f") {
      int n = 0;
      for (auto corner = text.word_in_line(); n < Polygons::min_corners || !corner.empty();
           corner = text.word_in_line()) {
        if (++n > Polygons::max_corners) text.fail("expected faces of up to 1000 corners, found one of more");
        faces.add_corner(corner_of(text, corner, surface.points.size()));
      }
      faces.end_face();
      result.parts.part.insert(result.parts.part.end(), static_cast<std::size_t>(n - 2),
                               part_called(result.parts, group));
    } else if (word == "g" || word == "o") {
      group = text.rest_of_line();
      if (std::find(groups.begin(), groups.end(), group) == groups.end()) groups.push_back(group);
    } else if (!others.count(word)) {
      text.fail("expected a statement of OBJ (v, f, vn, ...), found another");
    }
    text.skip_line();
  }
  faces.split(surface);
  std::vector<std::string> things;
  if (n_colors > 0) things.push_back("colors of " + counted(n_colors, "point", "points"));
  others.list(things);
  result.rest = remark_on_rest(things);
  things.insert(things.begin(), names_of_parts("groups", groups));
  surface.remarks = remark_on_rest(things);
  return result;
}

Triangulation parse_off(std::string_view bytes, const std::string& where) {
  Triangulation surface;
  SurfaceText text(bytes, where, '#');
  const auto extra = extra_of(text);
  const auto n_points = text.whole("number of points", 0, most);
  const auto n_faces = text.whole("number of faces", 0, most);
  text.whole("number of edges", 0, std::numeric_limits<std::int64_t>::max());
  for (std::int64_t i = 0; i < n_points; ++i) {
    const double x = text.number("x"), y = text.number("y"), z = text.number("z");
    surface.points.push_back({x, y, z});
    if (!extra.what.empty()) skip_numbers(text, extra);
  }
  Polygons faces;
  std::int64_t n_colors = 0;
  for (std::int64_t i = 0; i < n_faces; ++i) {
    const auto n = text.whole("corners of a face", Polygons::min_corners, Polygons::max_corners);
    for (std::int64_t k = 0; k < n; ++k)
      faces.add_corner(static_cast<int>(text.whole("point of a face", 0, n_points - 1)));
    faces.end_face();
    if (!text.word_in_line().empty()) ++n_colors;
    text.skip_line();
  }
  faces.split(surface);
  surface.remarks = remark_on_rest(
      {extra.what.empty() || n_points == 0 ? "" : extra.what + " of " + counted(n_points, "point", "points"),
       n_colors == 0 ? "" : "colors of " + counted(n_colors, "face", "faces")});
  if (!text.at_end()) text.fail("expected the end of the file after the last face, found more");
  return surface;
}

}  // namespace pamr::geometry
