// SPDX-License-Identifier: GPL-3.0-or-later
#include "report/camera.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "pamr/geometry/box.hpp"

namespace pamr::report {

namespace {

using geometry::Vec3;
using Corners = std::array<Vec3, 3>;

constexpr double enough = 0.3;       // of the picture; on the page, whose canvas has another shape, a quarter
constexpr std::size_t columns = 64;  // of the raster on which coverage is measured
constexpr std::size_t rows = 36;

/// Part of the picture that the triangles cover.
double covered_part(const std::vector<Corners>& triangles, const Camera& camera) {
  std::array<bool, columns * rows> is_covered{};
  const auto sample = [](double part, std::size_t n) {
    return static_cast<std::size_t>(std::clamp(part * static_cast<double>(n), 0.0, static_cast<double>(n - 1)));
  };
  for (const auto& triangle : triangles) {
    const auto [x, y, inverse] = project(triangle, camera);
    const auto [left, right] = std::minmax_element(x.begin(), x.end());
    const auto [high, low] = std::minmax_element(y.begin(), y.end());
    is_covered[sample((y[0] + y[1] + y[2]) / 3, rows) * columns + sample((x[0] + x[1] + x[2]) / 3, columns)] = true;
    const double twice_area = (x[1] - x[0]) * (y[2] - y[0]) - (x[2] - x[0]) * (y[1] - y[0]);
    for (auto row = sample(*high, rows); row <= sample(*low, rows); ++row)
      for (auto column = sample(*left, columns); column <= sample(*right, columns); ++column) {
        const double u = (static_cast<double>(column) + 0.5) / columns, v = (static_cast<double>(row) + 0.5) / rows;
        bool is_in = true;
        for (std::size_t a = 0; a < 3; ++a) {
          const std::size_t b = (a + 1) % 3;
          is_in = is_in && ((x[a] - u) * (y[b] - v) - (x[b] - u) * (y[a] - v)) * twice_area >= 0;
        }
        if (is_in) is_covered[row * columns + column] = true;
      }
  }
  return static_cast<double>(std::count(is_covered.begin(), is_covered.end(), true)) / (columns * rows);
}

/// Directions with this axis up, all around and from three heights, those near the usual one first.
std::vector<Direction> directions(std::size_t up_axis) {
  constexpr int n_around = 16;
  constexpr std::array heights{24.0, 8.0, 45.0};  // degrees
  constexpr double degree = std::numbers::pi / 180;
  std::vector<Direction> result;
  for (const double height : heights)
    for (int k = 0; k < n_around; ++k) {
      const double around = 229 * degree + 2 * std::numbers::pi * k / n_around;  // first as usual
      Direction direction{{}, {}};
      direction.up[up_axis] = 1;
      direction.from[up_axis] = std::sin(height * degree);
      direction.from[(up_axis + 1) % 3] = std::cos(height * degree) * std::cos(around);
      direction.from[(up_axis + 2) % 3] = std::cos(height * degree) * std::sin(around);
      result.push_back(direction);
    }
  const auto usual = (1 / norm(Direction().from)) * Direction().from;
  std::stable_sort(result.begin(), result.end(),
                   [&](const Direction& a, const Direction& b) { return dot(a.from, usual) > dot(b.from, usual); });
  return result;
}

}  // namespace

Camera::Camera(const Direction& direction, double aspect) {
  toward = (1 / norm(direction.from)) * direction.from;
  right = cross(direction.up, toward);
  right = (1 / norm(right)) * right;
  up = cross(toward, right);
  vertical = std::tan(half_view) / std::min(aspect, 1.0);
  horizontal = vertical * aspect;
}

void Camera::fit(const std::vector<Vec3>& points) {
  geometry::Box seen;
  for (const auto p : points) seen.extend({dot(p, right), dot(p, up), dot(p, toward)});
  if (seen.is_empty()) return;
  const auto middle = seen.center();
  target = middle.x * right + middle.y * up + middle.z * toward;
  for (const auto p : points) {
    const auto q = p - target;
    const double beside = std::max(std::abs(dot(q, right)) / horizontal, std::abs(dot(q, up)) / vertical);
    distance = std::max(distance, dot(q, toward) + 1.06 * beside);
  }
}

Projected project(const Corners& triangle, const Camera& camera) {
  Projected result;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto q = triangle[i] - camera.target;
    const double inverse = 1 / std::max(camera.distance - dot(q, camera.toward), 1e-9 * camera.distance);
    result.x[i] = 0.5 + 0.5 * dot(q, camera.right) * inverse / camera.horizontal;
    result.y[i] = 0.5 - 0.5 * dot(q, camera.up) * inverse / camera.vertical;
    result.inverse[i] = inverse;
  }
  return result;
}

Direction covering_direction(const std::vector<Corners>& triangles, double aspect) {
  std::vector<Vec3> points;
  points.reserve(3 * triangles.size());
  for (const auto& triangle : triangles) points.insert(points.end(), triangle.begin(), triangle.end());
  const auto part = [&](const Direction& direction) {
    Camera camera(direction, aspect);
    camera.fit(points);
    return covered_part(triangles, camera);
  };
  Direction best;
  if (triangles.empty()) return best;
  double most = part(best);
  for (const std::size_t up : {2, 1, 0})
    for (const auto& direction : directions(up)) {
      if (most >= enough) return best;
      if (const double covered = part(direction); covered > most + 0.01) {
        most = covered;
        best = direction;
      }
    }
  return best;
}

}  // namespace pamr::report
