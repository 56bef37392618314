// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <boost/math/quadrature/gauss.hpp>
#include <cmath>
#include <cstddef>

#include "pamr/geometry/quadratic_tet.hpp"

/// Cells of second order by their shape functions, as a finite element code evaluates them: nothing of the Bezier form.
namespace pamr::test {

using Barycentric = std::array<double, 4>;

/// Derivative of the map along the edge from corner 0 to corner k at a point.
inline geometry::Vec3 along_edge(const geometry::QuadraticTet& node, const Barycentric& l, std::size_t k) {
  std::array<double, 4> step{-1, 0, 0, 0};
  step[k] = 1;
  geometry::Vec3 sum;
  for (std::size_t i = 0; i < 4; ++i) {
    sum += (4 * l[i] - 1) * step[i] * node[i][i];
    for (std::size_t j = i + 1; j < 4; ++j) sum += 4 * (step[i] * l[j] + l[i] * step[j]) * node[i][j];
  }
  return sum;
}

inline double sampled_jacobian(const geometry::QuadraticTet& node, const Barycentric& l) {
  return dot(along_edge(node, l, 1), cross(along_edge(node, l, 2), along_edge(node, l, 3)));
}

/// The smallest of the Jacobians at the points with barycentric coordinates i/n.
inline double smallest_sample(const geometry::QuadraticTet& node, int n) {
  double smallest = 1e300;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j)
      for (int k = 0; i + j + k <= n; ++k) {
        const double h = 1.0 / n;
        smallest = std::fmin(smallest, sampled_jacobian(node, {h * (n - i - j - k), h * i, h * j, h * k}));
      }
  return smallest;
}

/// Volume by Keast's rule of five points, exact for the degree 3 that the Jacobian has.
inline double quadratic_volume(const geometry::QuadraticTet& node) {
  double sum = -0.8 * sampled_jacobian(node, {0.25, 0.25, 0.25, 0.25});
  for (std::size_t i = 0; i < 4; ++i) {
    Barycentric l{1.0 / 6, 1.0 / 6, 1.0 / 6, 1.0 / 6};
    l[i] = 0.5;
    sum += 0.45 * sampled_jacobian(node, l);
  }
  return sum / 6;
}

/// Area of the face opposite a corner, by Gauss's rule of five points in each direction of the square that is folded
/// onto the triangle.
inline double quadratic_face_area(const geometry::QuadraticTet& node, const std::array<int, 3>& corner) {
  const auto derivative = [&](const std::array<double, 3>& l, const std::array<double, 3>& step) {
    geometry::Vec3 sum;
    const auto at = [](int i) { return static_cast<std::size_t>(i); };
    for (std::size_t i = 0; i < 3; ++i) {
      sum += (4 * l[i] - 1) * step[i] * node[at(corner[i])][at(corner[i])];
      for (std::size_t j = i + 1; j < 3; ++j)
        sum += 4 * (step[i] * l[j] + l[i] * step[j]) * node[at(corner[i])][at(corner[j])];
    }
    return sum;
  };
  using Rule = boost::math::quadrature::gauss<double, 5>;
  return Rule::integrate(
      [&](double u) {
        return Rule::integrate(
            [&](double v) {
              const std::array<double, 3> l{1 - u - v, u, v};
              return norm(cross(derivative(l, {-1, 1, 0}), derivative(l, {-1, 0, 1})));
            },
            0.0, 1 - u);
      },
      0.0, 1.0);
}

}  // namespace pamr::test
