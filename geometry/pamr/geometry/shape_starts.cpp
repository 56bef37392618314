// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/shape_starts.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "pamr/geometry/symmetric_eigen.hpp"

namespace pamr::geometry {

namespace {

using Matrix = SquareMatrix<3>;

/// Least squares of rows `row . x = value`, by the normal equations; directions that no row determines get no part.
template <std::size_t N>
struct LinearFit {
  SquareMatrix<N> matrix{};
  std::array<double, N> right{};

  void add(const std::array<double, N>& row, double value) {
    for (std::size_t i = 0; i < N; ++i) {
      right[i] += row[i] * value;
      for (std::size_t k = 0; k < N; ++k) matrix[i][k] += row[i] * row[k];
    }
  }
  std::array<double, N> solve() const {
    constexpr double vanishing = 1e-12;
    auto diagonal = matrix;
    const auto axis = diagonalize<N>(diagonal);
    double largest = 0;
    for (std::size_t i = 0; i < N; ++i) largest = std::max(largest, diagonal[i][i]);
    std::array<double, N> x{};
    for (std::size_t i = 0; i < N; ++i) {
      if (!(diagonal[i][i] > vanishing * largest)) continue;
      double along = 0;
      for (std::size_t k = 0; k < N; ++k) along += axis[k][i] * right[k];
      for (std::size_t k = 0; k < N; ++k) x[k] += along / diagonal[i][i] * axis[k][i];
    }
    return x;
  }
};

Vec3 column(const Matrix& m, std::size_t i) { return {m[0][i], m[1][i], m[2][i]}; }

Vec3 mean(std::span<const Vec3> vectors) {
  Vec3 sum;
  for (const auto& v : vectors) sum += v;
  return (1 / static_cast<double>(vectors.size())) * sum;
}

/// Sum of the squares of the vectors, from `origin` on.
Matrix spread(std::span<const Vec3> vectors, Vec3 origin) {
  Matrix m{};
  for (const auto& vector : vectors) {
    const Vec3 v = vector - origin;
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) m[i][k] += v[i] * v[k];
  }
  return m;
}

void add_axes(Matrix m, std::vector<Vec3>& axes) {
  const auto vectors = diagonalize<3>(m);
  for (std::size_t i = 0; i < 3; ++i) axes.push_back(column(vectors, i));
}

/// The direction of the axis that the lines along the normals meet as nearly as they can: with moments m = p x n these
/// have n . c' + m . c = 0 for an axis of direction c and moment c'.
Vec3 axis_of_revolution(std::span<const Vec3> point, std::span<const Vec3> normal) {
  Matrix a{}, b{}, c{};
  for (std::size_t j = 0; j < point.size(); ++j) {
    const Vec3 n = normal[j], m = cross(point[j], n);
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        a[i][k] += n[i] * n[k];
        b[i][k] += n[i] * m[k];
        c[i][k] += m[i] * m[k];
      }
  }
  // c' = -a^-1 b c is best for each c; what is left is a form of c alone
  for (std::size_t k = 0; k < 3; ++k) {
    LinearFit<3> fit{a, {b[0][k], b[1][k], b[2][k]}};
    const auto x = fit.solve();
    for (std::size_t i = 0; i < 3; ++i)
      for (std::size_t l = 0; l < 3; ++l) c[i][k] -= b[l][i] * x[l];
  }
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < i; ++k) c[i][k] = c[k][i] = 0.5 * (c[i][k] + c[k][i]);
  const auto vectors = diagonalize<3>(c);
  std::size_t least = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (c[i][i] < c[least][least]) least = i;
  return column(vectors, least);
}

FittedShape sphere_start(std::span<const Vec3> point) {
  LinearFit<4> fit;
  for (const auto& p : point) fit.add({p.x, p.y, p.z, 1}, squared_norm(p));
  const auto x = fit.solve();
  FittedShape shape;
  shape.place = {0.5 * x[0], 0.5 * x[1], 0.5 * x[2]};
  shape.radius = std::sqrt(std::max(x[3] + squared_norm(shape.place), 0.0));
  return shape;
}

/// The axis of that direction that the normals meet best; nothing where they are all along it.
std::optional<Vec3> place_of_axis(Vec3 axis, std::span<const Vec3> point, std::span<const Vec3> normal) {
  LinearFit<3> fit;
  fit.add({axis.x, axis.y, axis.z}, 0);
  double weight = 0;
  for (std::size_t i = 0; i < point.size(); ++i) {
    const Vec3 beside = cross(axis, normal[i]);
    fit.add({beside.x, beside.y, beside.z}, dot(beside, point[i]));
    weight += squared_norm(beside);
  }
  if (!(weight > 1e-6 * static_cast<double>(point.size()))) return {};
  const auto x = fit.solve();
  return Vec3{x[0], x[1], x[2]};
}

/// The size of a shape about a given axis.
void fit_meridian(FittedShape& shape, std::span<const Vec3> point) {
  LinearFit<2> line;
  LinearFit<3> circle;
  double sum = 0;
  for (const auto& p : point) {
    const double x = dot(p - shape.place, shape.axis);
    const double r = norm(p - shape.place - x * shape.axis);
    line.add({x, 1}, r);
    circle.add({x, r, 1}, x * x + r * r);
    sum += r;
  }
  if (shape.kind == ShapeKind::cylinder) shape.radius = sum / static_cast<double>(point.size());
  if (shape.kind == ShapeKind::cone) {
    const auto [slope, at_place] = line.solve();
    const double steep = std::abs(slope) > 1e-6 ? slope : 1e-6;
    shape.place -= (at_place / steep) * shape.axis;
    shape.radius = std::atan(std::abs(steep));
    if (steep < 0) shape.axis = -shape.axis;
  }
  if (shape.kind == ShapeKind::torus) {
    const auto [x, r, rest] = circle.solve();
    shape.place += 0.5 * x * shape.axis;
    shape.radius = 0.5 * r;
    shape.of_tube = std::sqrt(std::max(rest + 0.25 * (x * x + r * r), 0.0));
  }
}

}  // namespace

std::vector<FittedShape> shape_starts(ShapeKind kind, std::span<const Vec3> point, std::span<const Vec3> normal) {
  if (kind == ShapeKind::sphere) return {sphere_start(point)};
  std::vector<Vec3> axes{axis_of_revolution(point, normal)};
  add_axes(spread(normal, {}), axes);
  add_axes(spread(normal, mean(normal)), axes);
  add_axes(spread(point, mean(point)), axes);
  std::vector<FittedShape> starts;
  for (const auto& axis : axes) {
    const auto place = place_of_axis(axis, point, normal);
    if (!place) continue;
    FittedShape shape;
    shape.kind = kind;
    shape.axis = axis;
    shape.place = *place;
    fit_meridian(shape, point);
    starts.push_back(shape);
  }
  return starts;
}

double distance_from_plane(std::span<const Vec3> point) {
  const Vec3 middle = mean(point);
  auto m = spread(point, middle);
  const auto vectors = diagonalize<3>(m);
  std::size_t least = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (m[i][i] < m[least][least]) least = i;
  double worst = 0;
  for (const auto& p : point) worst = std::max(worst, std::abs(dot(p - middle, column(vectors, least))));
  return worst;
}

}  // namespace pamr::geometry
