// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/read_ply.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>
#include <vector>

#include "pamr/base/counted.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/geometry/triangulated/polygons.hpp"
#include "pamr/geometry/triangulated/triangulation_text.hpp"

namespace pamr::geometry {

namespace {

enum class Scalar { i8, u8, i16, u16, i32, u32, f32, f64 };

struct Property {
  std::string name;
  Scalar type = Scalar::f32;
  bool is_list = false;
  Scalar count_type = Scalar::u8;
};

struct Element {
  std::string name;
  std::int64_t count = 0;
  std::vector<Property> properties;
};

Scalar scalar_of(const SurfaceText& text, std::string_view word) {
  struct Name {
    std::string_view text;
    Scalar type;
  };
  constexpr std::array<Name, 16> names{{{"char", Scalar::i8},
                                        {"int8", Scalar::i8},
                                        {"uchar", Scalar::u8},
                                        {"uint8", Scalar::u8},
                                        {"short", Scalar::i16},
                                        {"int16", Scalar::i16},
                                        {"ushort", Scalar::u16},
                                        {"uint16", Scalar::u16},
                                        {"int", Scalar::i32},
                                        {"int32", Scalar::i32},
                                        {"uint", Scalar::u32},
                                        {"uint32", Scalar::u32},
                                        {"float", Scalar::f32},
                                        {"float32", Scalar::f32},
                                        {"double", Scalar::f64},
                                        {"float64", Scalar::f64}}};
  for (const auto& name : names)
    if (word == name.text) return name.type;
  text.fail("expected a type of PLY (char to float64), found another word");
}

/// Where the numbers of the body come from: text, or bytes of either order.
class Body {
 public:
  Body(std::string_view bytes, std::string where, bool is_text, bool swap, std::size_t first_line)
      : bytes_(bytes), where_(std::move(where)), is_text_(is_text), swap_(swap), text_(bytes, where_, 0, first_line) {}

  double next(Scalar type, const std::string& what) {
    if (is_text_) return text_.number(what);
    switch (type) {
      case Scalar::i8:
        return raw<std::int8_t>(what);
      case Scalar::u8:
        return raw<std::uint8_t>(what);
      case Scalar::i16:
        return raw<std::int16_t>(what);
      case Scalar::u16:
        return raw<std::uint16_t>(what);
      case Scalar::i32:
        return raw<std::int32_t>(what);
      case Scalar::u32:
        return raw<std::uint32_t>(what);
      case Scalar::f32:
        return finite(raw<float>(what), what);
      default:
        return finite(raw<double>(what), what);
    }
  }

  bool at_end() { return is_text_ ? text_.at_end() : at_ == bytes_.size(); }
  [[noreturn]] void fail(const std::string& message) const {
    if (is_text_) text_.fail(message);
    throw Error(where_ + ": " + message);
  }

 private:
  template <class T>
  T raw(const std::string& what) {
    std::array<char, sizeof(T)> piece{};
    if (bytes_.size() - at_ < piece.size()) fail("expected " + what + ", found the end of the file");
    std::copy_n(bytes_.data() + at_, piece.size(), piece.begin());
    at_ += piece.size();
    if (swap_) std::reverse(piece.begin(), piece.end());
    return std::bit_cast<T>(piece);
  }
  double finite(double value, const std::string& what) const {
    if (!std::isfinite(value)) fail("expected a finite number (" + what + "), found NaN or infinity");
    return value;
  }

  std::string_view bytes_;
  std::string where_;
  bool is_text_, swap_;
  SurfaceText text_;
  std::size_t at_ = 0;
};

struct Head {
  bool is_text = false, swap = false;
  std::vector<Element> elements;
  std::size_t body = 0, body_line = 0;
};

void read_property(SurfaceText& text, std::vector<Element>& elements) {
  if (elements.empty()) text.fail("expected \"element\" before \"property\", found none");
  Property property;
  auto type = text.word_in_line();
  if (type == "list") {
    property.is_list = true;
    property.count_type = scalar_of(text, text.word_in_line());
    if (property.count_type == Scalar::f32 || property.count_type == Scalar::f64)
      text.fail("expected a whole type for the length of a list, found another");
    type = text.word_in_line();
  }
  property.type = scalar_of(text, type);
  property.name = text.word_in_line();
  if (property.name.empty()) text.fail("expected the name of the property, found none");
  elements.back().properties.push_back(property);
}

Head read_head(std::string_view bytes, const std::string& where) {
  Head head;
  SurfaceText text(bytes, where);
  if (text.word_in_line() != "ply") text.fail("expected \"ply\", found another word");
  text.skip_line();
  head.body_line = 2;
  for (bool has_format = false;; ++head.body_line) {
    if (text.bytes_left() == 0) text.fail("expected \"end_header\", found the end of the file");
    const auto word = text.word_in_line();
    if (word == "format") {
      const auto kind = text.word_in_line();
      constexpr bool is_little = std::endian::native == std::endian::little;
      head.is_text = kind == "ascii";
      head.swap = kind == (is_little ? "binary_big_endian" : "binary_little_endian");
      if (has_format || (!head.is_text && kind != "binary_big_endian" && kind != "binary_little_endian") ||
          text.word_in_line() != "1.0")
        text.fail("expected one format, ascii, binary_little_endian or binary_big_endian 1.0, found another");
      has_format = true;
    } else if (word == "element") {
      const std::string name(text.word_in_line());
      if (std::any_of(head.elements.begin(), head.elements.end(), [&](const auto& e) { return e.name == name; }))
        text.fail("expected each element once, found one twice");
      head.elements.push_back(
          {name, text.whole_of(text.word_in_line(), "number of elements", 0, std::numeric_limits<int>::max()), {}});
    } else if (word == "property") {
      read_property(text, head.elements);
    } else if (word == "end_header") {
      if (!has_format) text.fail("expected a line \"format\" in the head, found none");
      text.skip_line();
      head.body = text.position();
      ++head.body_line;
      return head;
    } else if (word != "comment" && word != "obj_info") {
      text.fail("expected \"element\", \"property\", \"comment\" or \"end_header\", found another word");
    }
    text.skip_line();
  }
}

void require_shape(const Element& element, const std::string& where) {
  const auto n_of = [&](std::string_view name, bool is_list) {
    return std::count_if(element.properties.begin(), element.properties.end(),
                         [&](const auto& p) { return p.name == name && p.is_list == is_list; });
  };
  if (element.name == "vertex" && (n_of("x", false) != 1 || n_of("y", false) != 1 || n_of("z", false) != 1))
    throw Error(where + ": expected the properties x, y and z of vertex, found others");
  if (element.name == "face" && n_of("vertex_indices", true) + n_of("vertex_index", true) != 1)
    throw Error(where + ": expected one list vertex_indices of face, found none or two");
  if (element.count > 0 && element.properties.empty())
    throw Error(where + ": expected properties of element " + element.name + ", found none");
}

void read_element(Body& body, const Element& element, std::int64_t n_points, Triangulation& surface, Polygons& faces) {
  const bool is_vertex = element.name == "vertex", is_face = element.name == "face";
  for (std::int64_t i = 0; i < element.count; ++i) {
    const auto what = fmt::format("{} {}", element.name, i);
    Vec3 point;
    for (const auto& property : element.properties) {
      if (!property.is_list) {
        const double value = body.next(property.type, what);
        if (property.name == "x") point.x = value;
        if (property.name == "y") point.y = value;
        if (property.name == "z") point.z = value;
        continue;
      }
      const double length = body.next(property.count_type, what);
      const bool is_polygon = is_face && property.name.starts_with("vertex_ind");
      if (length < 0 || length != std::floor(length) ||
          (is_polygon && (length < Polygons::min_corners || length > Polygons::max_corners)))
        body.fail(what + ": expected " + (is_polygon ? "3 to 1000 corners" : "a list") + ", found another length");
      for (double k = 0; k < length; ++k) {
        const double value = body.next(property.type, what);
        if (!is_polygon) continue;
        if (!(value >= 0 && value < static_cast<double>(n_points)) || value != std::floor(value))
          body.fail(fmt::format("{}: expected points from 0 to {}, found another number", what, n_points - 1));
        faces.add_corner(static_cast<int>(value));
      }
    }
    if (is_vertex) surface.points.push_back(point);
    if (is_face) faces.end_face();
  }
}

/// Properties of an element that are neither points nor faces of a surface, as "nx, ny of 8 points" or "7 elements 'edge'".
std::string rest_of(const Element& element) {
  const bool is_vertex = element.name == "vertex";
  if (element.count == 0) return {};
  if (!is_vertex && element.name != "face")
    return counted(element.count, "element", "elements") + " '" + element.name + "'";
  std::vector<std::string> names;
  for (const auto& property : element.properties) {
    const bool is_shape =
        is_vertex ? !property.is_list && (property.name == "x" || property.name == "y" || property.name == "z")
                  : property.is_list && property.name.starts_with("vertex_ind");
    if (!is_shape) names.push_back(property.name);
  }
  if (names.empty()) return {};
  return fmt::format("{} of {}", listed(names, {.most = all_items}),
                     is_vertex ? counted(element.count, "point", "points") : counted(element.count, "face", "faces"));
}

}  // namespace

Triangulation parse_ply(std::string_view bytes, const std::string& where) {
  const Head head = read_head(bytes, where);
  std::int64_t n_points = -1;
  bool has_faces = false;
  for (const auto& element : head.elements) {
    require_shape(element, where);
    if (element.name == "vertex") n_points = element.count;
    has_faces = has_faces || element.name == "face";
  }
  if (n_points < 0 || !has_faces) throw Error(where + ": expected the elements vertex and face, found others");
  Body body(bytes.substr(head.body), where, head.is_text, head.swap, head.body_line);
  Triangulation surface;
  Polygons faces;
  for (const auto& element : head.elements) read_element(body, element, n_points, surface, faces);
  if (!body.at_end()) body.fail("expected the end of the file after the last element, found more");
  faces.split(surface);
  std::vector<std::string> rest;
  for (const auto& element : head.elements) rest.push_back(rest_of(element));
  surface.remarks = remark_on_rest(rest);
  return surface;
}

}  // namespace pamr::geometry
