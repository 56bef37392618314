// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/jet.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pamr/geometry/symmetric_eigen.hpp"

namespace pamr::geometry {

namespace {

constexpr std::size_t n = 5;  // d, e, a, b, c
using Vector = std::array<double, n>;
using Matrix = SquareMatrix<n>;

/// Solution of least length of the normal equations.
Vector solve(Matrix m, const Vector& right) {
  constexpr double cut = 1e-9;
  const Matrix v = diagonalize<n>(m, {12, 0, 0}, PlainRoot{});
  double largest = 0;
  for (std::size_t i = 0; i < n; ++i) largest = std::max(largest, m[i][i]);
  Vector x{};
  for (std::size_t i = 0; i < n; ++i) {
    if (!(m[i][i] > cut * largest)) continue;
    double part = 0;
    for (std::size_t k = 0; k < n; ++k) part += v[k][i] * right[k];
    for (std::size_t k = 0; k < n; ++k) x[k] += part / m[i][i] * v[k][i];
  }
  return x;
}

}  // namespace

Vec3 jet_normal(Vec3 origin, Vec3 guess, std::span<const Vec3> points) {
  double size = 0;
  for (const Vec3 p : points) size = std::max(size, norm(p - origin));
  if (!(size > 0)) return guess;
  const Vec3 axis = std::abs(guess.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  const Vec3 across = cross(guess, axis);
  const Vec3 first = (1 / norm(across)) * across, second = cross(guess, first);
  Matrix m{};
  Vector right{};
  for (const Vec3 p : points) {
    const Vec3 d = (1 / size) * (p - origin);
    const double weight = 1 / std::max(squared_norm(d), 1e-6);
    const double x = dot(d, first), y = dot(d, second), z = dot(d, guess);
    const Vector row{x, y, x * x, x * y, y * y};
    for (std::size_t i = 0; i < n; ++i) {
      right[i] += weight * row[i] * z;
      for (std::size_t k = 0; k < n; ++k) m[i][k] += weight * row[i] * row[k];
    }
  }
  const Vector jet = solve(m, right);
  const Vec3 normal = guess - jet[0] * first - jet[1] * second;
  return (1 / norm(normal)) * normal;
}

}  // namespace pamr::geometry
