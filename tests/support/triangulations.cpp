// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/triangulations.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <numbers>

namespace pamr::testing {

using geometry::Triangulation;
using geometry::Vec3;

namespace {

constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }

std::string text_of(double x) {
  char text[40];
  std::snprintf(text, sizeof text, "%.17g", x);
  return text;
}

std::string text_of(Vec3 p) { return text_of(p.x) + " " + text_of(p.y) + " " + text_of(p.z); }

template <class T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

}  // namespace

Triangulation icosphere(int levels) {
  const double t = (1 + std::sqrt(5.0)) / 2;
  Triangulation s;
  s.points = {{-1, t, 0},  {1, t, 0},  {-1, -t, 0}, {1, -t, 0}, {0, -1, t},  {0, 1, t},
              {0, -1, -t}, {0, 1, -t}, {t, 0, -1},  {t, 0, 1},  {-t, 0, -1}, {-t, 0, 1}};
  for (auto& p : s.points) p = (1 / norm(p)) * p;
  s.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                 {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                 {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  for (int level = 0; level < levels; ++level) {
    std::map<std::array<int, 2>, int> middles;
    const auto middle = [&](int a, int b) {
      const auto [place, is_new] =
          middles.emplace(std::array{std::min(a, b), std::max(a, b)}, static_cast<int>(s.points.size()));
      if (is_new) {
        const Vec3 p = midpoint(s.points[at(a)], s.points[at(b)]);
        s.points.push_back((1 / norm(p)) * p);
      }
      return place->second;
    };
    std::vector<std::array<int, 3>> next;
    for (const auto& [a, b, c] : s.triangles) {
      const int ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
      next.insert(next.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
    }
    s.triangles = std::move(next);
  }
  return s;
}

Triangulation bored_cube(int n) {
  Triangulation s;
  for (const double z : {-1.0, 1.0})  // corners of the bottom 0 to 3, of the top 4 to 7, counter-clockwise from (1, 1)
    s.points.insert(s.points.end(), {{1, 1, z}, {-1, 1, z}, {-1, -1, z}, {1, -1, z}});
  for (const double z : {-1.0, 1.0})
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * (i + 0.5 * n / 4) / n;  // starts at 45 degrees, as corner 0
      s.points.push_back({0.5 * std::cos(angle), 0.5 * std::sin(angle), z});
    }
  const auto rim = [n](int side, int i) { return 8 + side * n + i % n; };
  for (int q = 0; q < 4; ++q) {
    const int next = (q + 1) % 4;
    s.triangles.insert(s.triangles.end(), {{q, q + 4, next + 4}, {q, next + 4, next}});
    const int first = q * n / 4, last = (q + 1) * n / 4, half = (first + last) / 2;
    for (const int side : {0, 1}) {
      const auto add = [&](int a, int b, int c) {
        if (side == 1)
          s.triangles.push_back({a, b, c});
        else
          s.triangles.push_back({a, c, b});
      };
      for (int i = first; i < half; ++i) add(4 * side + q, rim(side, i + 1), rim(side, i));
      add(4 * side + q, 4 * side + next, rim(side, half));
      for (int i = half; i < last; ++i) add(4 * side + next, rim(side, i + 1), rim(side, i));
    }
  }
  for (int i = 0; i < n; ++i)
    s.triangles.insert(s.triangles.end(),
                       {{rim(0, i), rim(0, i + 1), rim(1, i + 1)}, {rim(0, i), rim(1, i + 1), rim(1, i)}});
  for (std::size_t t = s.triangles.size() - at(2 * n); t < s.triangles.size(); ++t)
    std::swap(s.triangles[t][1], s.triangles[t][2]);
  for (auto& triangle : s.triangles) {  // the sides of the cube above run clockwise from outside, too
    const Vec3 a = s.points[at(triangle[0])], b = s.points[at(triangle[1])], c = s.points[at(triangle[2])];
    const Vec3 middle = (1.0 / 3) * (a + b + c), normal = cross(b - a, c - a);
    const bool is_side = std::max(std::abs(middle.x), std::abs(middle.y)) > 1 - 1e-9;
    if (is_side && dot(normal, middle) < 0) std::swap(triangle[1], triangle[2]);
  }
  return s;
}

Triangulation lens(int n, int n_rings, double height) {
  Triangulation s;
  const double radius = (1 + height * height) / (2 * height);  // of the spheres
  const auto point = [&](double r, double turns, double side) {
    const double angle = 2 * std::numbers::pi * turns / n;
    return Vec3{r * std::cos(angle), r * std::sin(angle),
                side * (std::sqrt(radius * radius - r * r) - (radius - height))};
  };
  for (int i = 0; i < n; ++i) s.points.push_back(point(1, i, 0));
  for (const int side : {-1, 1}) {
    const auto add = [&](int a, int b, int c) {
      s.triangles.push_back(side > 0 ? std::array{a, b, c} : std::array{a, c, b});
    };
    std::vector<int> ring;
    for (int i = 0; i < n; ++i) ring.push_back(i);
    for (int k = 1; k < n_rings; ++k) {
      const auto outer = ring;
      for (int i = 0; i < n; ++i) {
        ring[at(i)] = static_cast<int>(s.points.size());
        s.points.push_back(point(1 - static_cast<double>(k) / n_rings, i + 0.5 * k, side));
      }
      for (int i = 0; i < n; ++i) {
        const int next = (i + 1) % n;
        add(outer[at(i)], outer[at(next)], ring[at(i)]);
        add(outer[at(next)], ring[at(next)], ring[at(i)]);
      }
    }
    const auto top = static_cast<int>(s.points.size());
    s.points.push_back(point(0, 0, side));
    for (int i = 0; i < n; ++i) add(ring[at(i)], ring[at((i + 1) % n)], top);
  }
  return s;
}

std::string as_stl_text(const Triangulation& s) {
  std::string text = "solid made for a test\n";
  for (const auto& triangle : s.triangles) {
    text += " facet normal 0 0 0\n  outer loop\n";
    for (const int p : triangle) text += "   vertex " + text_of(s.points[at(p)]) + "\n";
    text += "  endloop\n endfacet\n";
  }
  return text + "endsolid\n";
}

std::string as_stl_bytes(const Triangulation& s) {
  std::string bytes(80, ' ');
  append(bytes, static_cast<std::uint32_t>(s.triangles.size()));
  for (const auto& triangle : s.triangles) {
    for (int i = 0; i < 3; ++i) append(bytes, 0.0F);
    for (const int p : triangle)
      for (const double x : {s.points[at(p)].x, s.points[at(p)].y, s.points[at(p)].z})
        append(bytes, static_cast<float>(x));
    append(bytes, std::uint16_t{0});
  }
  return bytes;
}

std::string as_obj(const Triangulation& s) {
  std::string text = "# made for a test\n";
  for (const Vec3 p : s.points) text += "v " + text_of(p) + "\n";
  for (const auto& [a, b, c] : s.triangles)
    text += "f " + std::to_string(a + 1) + " " + std::to_string(b + 1) + "//1 " + std::to_string(c + 1) + "\n";
  return text;
}

std::string as_off(const Triangulation& s) {
  std::string text = "OFF\n" + std::to_string(s.points.size()) + " " + std::to_string(s.triangles.size()) + " 0\n";
  for (const Vec3 p : s.points) text += text_of(p) + "\n";
  for (const auto& [a, b, c] : s.triangles)
    text += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  return text;
}

namespace {

std::string ply_head(const Triangulation& s, const std::string& format) {
  return "ply\nformat " + format + " 1.0\ncomment made for a test\nelement vertex " + std::to_string(s.points.size()) +
         "\nproperty double x\nproperty double y\nproperty double z\nelement face " +
         std::to_string(s.triangles.size()) + "\nproperty list uchar int vertex_indices\nend_header\n";
}

}  // namespace

std::string as_ply_text(const Triangulation& s) {
  std::string text = ply_head(s, "ascii");
  for (const Vec3 p : s.points) text += text_of(p) + "\n";
  for (const auto& [a, b, c] : s.triangles)
    text += "3 " + std::to_string(a) + " " + std::to_string(b) + " " + std::to_string(c) + "\n";
  return text;
}

std::string as_ply_bytes(const Triangulation& s) {
  std::string bytes = ply_head(s, "binary_little_endian");
  for (const Vec3 p : s.points)
    for (const double x : {p.x, p.y, p.z}) append(bytes, x);
  for (const auto& triangle : s.triangles) {
    append(bytes, std::uint8_t{3});
    for (const int p : triangle) append(bytes, std::int32_t{p});
  }
  return bytes;
}

}  // namespace pamr::testing
