// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <numbers>
#include <vector>

#include "pamr/geometry/vec3.hpp"

namespace pamr::report {

/// From where a picture is seen: not unit vectors.
struct Direction {
  geometry::Vec3 from{-1.05, -1.22, 0.72};
  geometry::Vec3 up{0, 0, 1};
};

/// Pixels of the still picture, and half the angle of its view.
inline constexpr int picture_width = 1000, picture_height = 560;
inline constexpr double half_view = 17.5 * std::numbers::pi / 180;

/// A camera that sees positions from one direction, as `look` of page/view.js makes it.
struct Camera {
  geometry::Vec3 toward, right, up, target{};
  double distance = 0, horizontal = 0, vertical = 0;  ///< tangents of half the angles of the view

  Camera(const Direction& direction, double aspect);

  /// Comes as near as shows all of these points.
  void fit(const std::vector<geometry::Vec3>& points);
};

/// A triangle in a picture.
struct Projected {
  std::array<double, 3> x{}, y{};   ///< parts of the picture, from its upper left corner
  std::array<double, 3> inverse{};  ///< one over the distances along the view
};

Projected project(const std::array<geometry::Vec3, 3>& triangle, const Camera& camera);

/// The direction nearest to the usual one in which these triangles cover three tenths of a picture, with z up if there
/// is one; if there is none at all, the one in which they cover the most. Local; O(triangles), 145 times at most.
Direction covering_direction(const std::vector<std::array<geometry::Vec3, 3>>& triangles, double aspect);

}  // namespace pamr::report
