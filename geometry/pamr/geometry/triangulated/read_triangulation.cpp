// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/read_triangulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <limits>
#include <optional>
#include <set>
#include <span>
#include <utility>

#include "pamr/base/byte_order_mark.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/base/read_file.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/geometry/triangulated/check_triangulation.hpp"
#include "pamr/geometry/triangulated/edge_table.hpp"
#include "pamr/geometry/triangulated/read_obj.hpp"
#include "pamr/geometry/triangulated/read_ply.hpp"
#include "pamr/geometry/triangulated/read_stl.hpp"
#include "pamr/geometry/triangulated/write_triangulation.hpp"

namespace pamr::geometry {

namespace {

std::string bytes_of(const std::filesystem::path& file) {
  errno = 0;
  std::error_code error;
  auto bytes = std::filesystem::is_regular_file(file, error) ? read_file(file) : std::nullopt;
  if (!bytes)
    throw Error(file.string() + ": expected a surface file that can be read, found " +
                (std::filesystem::is_directory(file, error) ? "a folder"
                 : errno != 0                               ? std::strerror(errno)
                                                            : "no such file"));
  return std::move(*bytes);
}

NamedTriangulation parse(std::string_view bytes, const std::string& where) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw Error(fmt::format("{}: expected a surface file below 2 GiB, found {} bytes", where, bytes.size()));
  const auto text = without_byte_order_mark(bytes);
  switch (surface_format_of(where)) {
    case SurfaceFormat::obj:
      return parse_obj(text, where);
    case SurfaceFormat::ply:
      return {parse_ply(text, where), {}, {}};
    case SurfaceFormat::off:
      return {parse_off(text, where), {}, {}};
    default:
      return parse_stl(bytes, where);
  }
}

/// Makes one part without a name of those that are not chosen. Returns their names.
std::vector<std::string> keep_parts(NamedParts& parts, const PartChoice& is_part) {
  NamedParts kept;
  std::vector<int> now;
  std::vector<std::string> left_out;
  for (const auto& name : parts.name) {
    const bool stays = is_part && is_part(name);
    if (!stays && !name.empty()) left_out.push_back(name);
    now.push_back(part_called(kept, stays ? name : ""));
  }
  for (const int part : parts.part) kept.part.push_back(now[at(part)]);
  parts = std::move(kept);
  return left_out;
}

/// Parts of one surface meet in edges of two triangles; bodies that touch have more there.
void refuse_common_faces(const NamedTriangulation& file, const std::string& where) {
  for (const auto& [a, b, c] : file.surface.triangles)
    if (a == b || b == c || c == a) return;  // which is refused later
  EdgeTable(file.surface).for_each_edge([&](std::span<const Side> sides) {
    std::set<int> parts;
    for (const auto& side : sides) parts.insert(file.parts.part[at(side.triangle)]);
    if (sides.size() < 3 || parts.size() < 2) return;
    throw Error(fmt::format(
        "{}: expected named parts of one surface, at most two triangles at each edge, found {} of parts {} at the edge "
        "from {} to {}: leave out the faces between bodies that touch, or give the bodies as a CAD file, which becomes "
        "a region for each",
        where, sides.size(),
        listed(parts, {.before_last = " and "}, [&](int part) { return '"' + file.parts.name[at(part)] + '"'; }),
        decimal(file.surface.points[at(sides[0].low)]), decimal(file.surface.points[at(sides[0].high)])));
  });
}

}  // namespace

Triangulation read_triangulation(const std::filesystem::path& file, Exact<bool> open_allowed) {
  return parse_triangulation(bytes_of(file), file.string(), open_allowed);
}

Triangulation parse_triangulation(std::string_view bytes, const std::string& where, Exact<bool> open_allowed) {
  auto surface = parse(bytes, where).surface;
  drop_unused_points(surface);
  require_valid(surface, where, open_allowed);
  return surface;
}

NamedTriangulation read_named_triangulation(const std::filesystem::path& file, Exact<bool> open_allowed,
                                            const PartChoice& is_part) {
  const auto where = file.string();
  auto read = parse(bytes_of(file), where);
  drop_unused_points(read.surface);
  if (read.parts.name.size() > 1) refuse_common_faces(read, where);
  const auto left_out = keep_parts(read.parts, is_part);
  if (read.parts.name.size() > 1) {
    read.surface.remarks = read.rest;
    if (!left_out.empty())
      read.surface.remarks.push_back(
          fmt::format("left out: the {} {}", left_out.size() == 1 ? "name" : "names",
                      listed(left_out, {}, [](const auto& name) { return '"' + name + '"'; })));
  } else {
    read.parts = {};
  }
  require_valid(read.surface, where, open_allowed);
  return read;
}

Triangulation read_soup(const std::filesystem::path& file) { return parse_soup(bytes_of(file), file.string()); }

Triangulation parse_soup(std::string_view bytes, const std::string& where) {
  auto surface = parse(bytes, where).surface;
  const auto n_points = std::ssize(surface.points);
  for (std::ptrdiff_t i = 0; i < n_points; ++i)
    if (const Vec3 p = surface.points[static_cast<std::size_t>(i)]; !is_in_range(p))
      throw Error(fmt::format("{}: point {}: expected finite coordinates below {}, found {}", where, i + 1,
                              max_coordinate_text, decimal(p)));
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (const int p : surface.triangles[t])
      if (p < 0 || p >= n_points)
        throw Error(fmt::format("{}: triangle {}: expected points from 1 to {}, found {}", where, t + 1, n_points,
                                std::int64_t{p} + 1));
  return surface;
}

}  // namespace pamr::geometry
