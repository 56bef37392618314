// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/write_triangulation.hpp"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/triangulated/triangulation_text.hpp"

namespace pamr::geometry {

namespace {

template <class T>
void append_raw(std::string& text, T value) {
  std::array<char, sizeof(T)> bytes{};
  std::memcpy(bytes.data(), &value, sizeof value);
  text.append(bytes.data(), bytes.size());
}

/// Unit normal of a triangle; zero where it has none.
Vec3 facet_normal(const std::array<Vec3, 3>& p) {
  const Vec3 normal = cross(p[1] - p[0], p[2] - p[0]);
  const double length = norm(normal);
  return length > 0 && std::isfinite(length) ? (1 / length) * normal : Vec3{};
}

}  // namespace

SurfaceFormat surface_format_of(const std::filesystem::path& file) {
  const auto ending = file.extension().string();
  if (is_same_word(ending, ".stl")) return SurfaceFormat::stl;
  if (is_same_word(ending, ".obj")) return SurfaceFormat::obj;
  if (is_same_word(ending, ".ply")) return SurfaceFormat::ply;
  if (is_same_word(ending, ".off")) return SurfaceFormat::off;
  throw Error(file.string() + ": expected a surface file ending in .stl, .obj, .ply or .off, found \"" + ending + "\"");
}

std::string surface_head(SurfaceFormat format, std::int64_t n_points, std::int64_t n_triangles) {
  switch (format) {
    case SurfaceFormat::stl:
      return "solid surface\n";
    case SurfaceFormat::stl_single: {
      constexpr std::size_t title_bytes = 80;
      std::string head = "surface of triangles, single precision";  // must not begin with "solid"
      head.resize(title_bytes, ' ');
      append_raw(head, static_cast<std::uint32_t>(n_triangles));
      return head;
    }
    case SurfaceFormat::obj:
      return {};
    case SurfaceFormat::ply:
      return fmt::format(
          "ply\nformat binary_{}_endian 1.0\nelement vertex {}\nproperty double x\nproperty double y\n"
          "property double z\nelement face {}\nproperty list uchar int vertex_indices\nend_header\n",
          std::endian::native == std::endian::little ? "little" : "big", n_points, n_triangles);
    case SurfaceFormat::off:
      return fmt::format("OFF\n{} {} 0\n", n_points, n_triangles);
  }
  return {};
}

void append_points(std::string& text, SurfaceFormat format, std::span<const Vec3> points) {
  if (format == SurfaceFormat::stl || format == SurfaceFormat::stl_single) return;
  for (const Vec3 p : points) {
    if (format == SurfaceFormat::ply)
      for (const double x : {p.x, p.y, p.z}) append_raw(text, x);
    else
      fmt::format_to(std::back_inserter(text), "{}{} {} {}\n", format == SurfaceFormat::obj ? "v " : "", p.x, p.y, p.z);
  }
}

void append_triangle(std::string& text, SurfaceFormat format, const std::array<std::int64_t, 3>& point,
                     const std::array<Vec3, 3>& corner) {
  const auto out = std::back_inserter(text);
  switch (format) {
    case SurfaceFormat::stl: {
      const Vec3 n = facet_normal(corner);
      fmt::format_to(out, "facet normal {} {} {}\nouter loop\n", n.x, n.y, n.z);
      for (const Vec3 p : corner) fmt::format_to(out, "vertex {} {} {}\n", p.x, p.y, p.z);
      fmt::format_to(out, "endloop\nendfacet\n");
      return;
    }
    case SurfaceFormat::stl_single:
      for (const Vec3 p : {facet_normal(corner), corner[0], corner[1], corner[2]})
        for (const double x : {p.x, p.y, p.z}) append_raw(text, static_cast<float>(x));
      append_raw(text, std::uint16_t{0});
      return;
    case SurfaceFormat::obj:
      fmt::format_to(out, "f {} {} {}\n", point[0] + 1, point[1] + 1, point[2] + 1);
      return;
    case SurfaceFormat::ply:
      append_raw(text, std::uint8_t{3});
      for (const auto n : point) append_raw(text, static_cast<std::int32_t>(n));
      return;
    case SurfaceFormat::off:
      fmt::format_to(out, "3 {} {} {}\n", point[0], point[1], point[2]);
      return;
  }
}

std::string surface_end(SurfaceFormat format) { return format == SurfaceFormat::stl ? "endsolid surface\n" : ""; }

std::string to_bytes(const Triangulation& surface, SurfaceFormat format) {
  auto text = surface_head(format, std::ssize(surface.points), std::ssize(surface.triangles));
  append_points(text, format, surface.points);
  for (const auto& [a, b, c] : surface.triangles)
    append_triangle(text, format, {a, b, c}, {surface.points[at(a)], surface.points[at(b)], surface.points[at(c)]});
  return text + surface_end(format);
}

}  // namespace pamr::geometry
