// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/read_triangulation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fstream>
#include <iterator>
#include <limits>

#include "pamr/base/byte_order_mark.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/geometry/triangulated/check_triangulation.hpp"
#include "pamr/geometry/triangulated/read_obj.hpp"
#include "pamr/geometry/triangulated/read_ply.hpp"
#include "pamr/geometry/triangulated/read_stl.hpp"
#include "pamr/geometry/triangulated/write_triangulation.hpp"

namespace pamr::geometry {

namespace {

constexpr double largest_size = 1e100;  // squares of lengths stay finite

std::string bytes_of(const std::filesystem::path& file) {
  errno = 0;
  std::ifstream stream(file, std::ios::binary);
  std::error_code error;
  if (!stream || !std::filesystem::is_regular_file(file, error))
    throw Error(file.string() + ": expected a surface file that can be read, found " +
                (errno != 0 ? std::strerror(errno) : "no such file"));
  std::string bytes{std::istreambuf_iterator<char>(stream), {}};
  if (stream.bad()) throw Error(file.string() + ": cannot be read");
  return bytes;
}

Triangulation parse(std::string_view bytes, const std::string& where) {
  if (bytes.size() > static_cast<std::size_t>(std::numeric_limits<int>::max()))
    throw Error(fmt::format("{}: expected a surface file below 2 GiB, found {} bytes", where, bytes.size()));
  const auto text = without_byte_order_mark(bytes);
  switch (surface_format_of(where)) {
    case SurfaceFormat::obj:
      return parse_obj(text, where);
    case SurfaceFormat::ply:
      return parse_ply(text, where);
    case SurfaceFormat::off:
      return parse_off(text, where);
    default:
      return parse_stl(bytes, where);
  }
}

}  // namespace

Triangulation read_triangulation(const std::filesystem::path& file, Exact<bool> open_allowed) {
  return parse_triangulation(bytes_of(file), file.string(), open_allowed);
}

Triangulation parse_triangulation(std::string_view bytes, const std::string& where, Exact<bool> open_allowed) {
  auto surface = parse(bytes, where);
  drop_unused_points(surface);
  require_valid(surface, where, open_allowed);
  return surface;
}

Triangulation read_soup(const std::filesystem::path& file) { return parse_soup(bytes_of(file), file.string()); }

Triangulation parse_soup(std::string_view bytes, const std::string& where) {
  auto surface = parse(bytes, where);
  const auto n_points = std::ssize(surface.points);
  for (std::ptrdiff_t i = 0; i < n_points; ++i)
    if (const Vec3 p = surface.points[static_cast<std::size_t>(i)]; !(largest_coordinate(p) < largest_size))
      throw Error(
          fmt::format("{}: point {}: expected finite coordinates below 1e100, found {}", where, i + 1, decimal(p)));
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (const int p : surface.triangles[t])
      if (p < 0 || p >= n_points)
        throw Error(fmt::format("{}: triangle {}: expected points from 1 to {}, found {}", where, t + 1, n_points,
                                std::int64_t{p} + 1));
  return surface;
}

}  // namespace pamr::geometry
