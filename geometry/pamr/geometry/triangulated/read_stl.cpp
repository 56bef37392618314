// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/read_stl.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <unordered_map>
#include <vector>

#include "pamr/base/byte_order_mark.hpp"
#include "pamr/base/counted.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/geometry/triangulated/triangulation_text.hpp"

namespace pamr::geometry {

namespace {

constexpr std::size_t head_bytes = 84, facet_bytes = 50;
constexpr std::string_view blanks = " \t\r\n\v\f";
constexpr std::string_view padding(" \t\r\n\v\f\0\x1a", 8);  // to whole blocks, and the end of a file of CP/M

struct HashOfPoint {
  std::size_t operator()(Vec3 p) const {
    const auto bits = [](double x) { return std::bit_cast<std::uint64_t>(x); };
    return combine(combine(bits(p.x), bits(p.y)), bits(p.z));
  }
};

/// Collects corners; equal ones become one point, in the order of their first use.
class Welder {
 public:
  int add(Vec3 p) {
    p = p + Vec3{};  // -0 becomes 0
    const auto [place, is_new] = number_.emplace(p, static_cast<int>(result.points.size()));
    if (is_new) result.points.push_back(p);
    return place->second;
  }
  Triangulation result;

 private:
  std::unordered_map<Vec3, int, HashOfPoint> number_;
};

/// The facets that the head of a binary file announces.
std::uint32_t facets_in_head(std::string_view bytes) {
  std::uint32_t n = 0;
  if (bytes.size() >= head_bytes) std::memcpy(&n, bytes.data() + head_bytes - sizeof n, sizeof n);
  return n;
}

/// How many bytes follow the facets of a binary file; negative where it is too short to be one.
std::int64_t bytes_behind(std::string_view bytes) {
  const auto needed = static_cast<std::int64_t>(head_bytes + facet_bytes * std::uint64_t{facets_in_head(bytes)});
  return std::ssize(bytes) - needed;
}

Triangulation parse_binary(std::string_view bytes, const std::string& where) {
  const std::int64_t n = facets_in_head(bytes), behind = bytes_behind(bytes);
  Welder welder;
  std::int64_t n_attributes = 0;
  for (std::int64_t f = 0; f < n; ++f) {
    float value[12];  // normal, which need not be right, and three corners
    const char* facet = bytes.data() + head_bytes + facet_bytes * static_cast<std::size_t>(f);
    std::memcpy(value, facet, sizeof value);
    n_attributes += facet[facet_bytes - 2] != 0 || facet[facet_bytes - 1] != 0 ? 1 : 0;
    for (int i = 3; i < 12; ++i)
      if (!std::isfinite(value[i]))
        throw Error(fmt::format("{}: triangle {}: expected finite coordinates, found NaN or infinity", where, f + 1));
    std::array<int, 3> corner{};
    for (std::size_t k = 0; k < 3; ++k) corner[k] = welder.add({value[3 + 3 * k], value[4 + 3 * k], value[5 + 3 * k]});
    welder.result.triangles.push_back(corner);
  }
  welder.result.remarks = remark_on_rest(
      {n_attributes == 0 ? "" : "attribute bytes, which may be colors, of " + counted(n_attributes, "face", "faces"),
       behind <= 0
           ? ""
           : fmt::format("{} behind the {} triangles that the file announces", counted(behind, "byte", "bytes"), n)});
  return std::move(welder.result);
}

/// Goes on behind "outer". The normal before it need not be right, nor numbers, nor there.
void skip_normal(SurfaceText& text) {
  constexpr int n_numbers = 3;
  auto word = text.word("\"normal\" or \"outer\"");
  if (is_same_word(word, "normal"))
    for (int i = 0; i <= n_numbers && !(i > 0 && is_same_word(word, "outer")); ++i) word = text.word("\"outer\"");
  if (!is_same_word(word, "outer")) text.fail("expected \"outer\", found another word");
}

NamedTriangulation parse_ascii(std::string_view bytes, const std::string& where) {
  Welder welder;
  NamedParts parts;
  std::vector<std::string> names;
  SurfaceText text(bytes.substr(0, bytes.find_last_not_of(padding) + 1), where);
  while (!text.at_end()) {
    text.expect("solid");
    names.push_back(text.rest_of_line());
    text.skip_line();
    for (int part = -1;;) {
      const auto word = text.word("\"facet\" or \"endsolid\"");
      if (is_same_word(word, "endsolid")) break;
      if (!is_same_word(word, "facet")) text.fail("expected \"facet\" or \"endsolid\", found another word");
      skip_normal(text);
      text.expect("loop");
      std::array<int, 3> corner{};
      for (int& point : corner) {
        text.expect("vertex");
        const double x = text.number("x"), y = text.number("y"), z = text.number("z");
        point = welder.add({x, y, z});
      }
      text.expect("endloop");
      text.expect("endfacet");
      welder.result.triangles.push_back(corner);
      if (part < 0) part = part_called(parts, names.back());
      parts.part.push_back(part);
    }
    text.skip_line();
  }
  welder.result.remarks = remark_on_rest({names_of_parts("solids", names)});
  return {std::move(welder.result), std::move(parts), {}};
}

bool is_text(std::string_view bytes) {
  bytes.remove_prefix(std::min(bytes.find_first_not_of(blanks), bytes.size()));
  return bytes.substr(0, bytes.find_first_of("\r\n")).find('\0') == std::string_view::npos &&
         is_same_word(bytes.substr(0, 5), "solid");
}

}  // namespace

NamedTriangulation parse_stl(std::string_view bytes, const std::string& where) {
  const auto without_names = [&] { return NamedTriangulation{parse_binary(bytes, where), {}, {}}; };
  // Binary files may begin with "solid" or a mark of byte order too, so the size decides first.
  if (bytes_behind(bytes) == 0) return without_names();
  bytes = without_byte_order_mark(bytes);
  if (bytes_behind(bytes) == 0) return without_names();
  if (is_text(bytes)) return parse_ascii(bytes, where);
  if (facets_in_head(bytes) > 0 && bytes_behind(bytes) > 0) return without_names();
  throw Error(
      fmt::format("{}: expected STL, \"solid\" or 84 bytes and 50 for each triangle that they announce, found {} bytes",
                  where, bytes.size()));
}

}  // namespace pamr::geometry
