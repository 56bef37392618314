// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/curved/bulge_energy.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>

#include "pamr/base/index.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::curved {

namespace {

using geometry::Vec3;

using Components = std::array<double, 18>;  ///< of the free bulges, in the front

/// The edges whose bulges are free, ascending.
struct FreeEdges {
  explicit FreeEdges(unsigned is_free) {
    for (unsigned rest = is_free; rest != 0; rest &= rest - 1) edge[n++] = at(std::countr_zero(rest));
  }
  std::array<std::size_t, 6> edge{};
  std::size_t n = 0;
};

/// `slopes[q][e][a]`: what a unit bulge of edge e adds to row a at sample point q.
constexpr auto make_slopes() {
  std::array<std::array<std::array<double, 3>, 6>, sample_points.size()> slope{};
  for (std::size_t q = 0; q < sample_points.size(); ++q)
    for (std::size_t e = 0; e < 6; ++e) {
      const auto [i, j] = mesh::tet::edge_to_corner[e];
      std::array<double, 4> derivative{};  // of 4 l_i l_j
      derivative[at(i)] = 4 * sample_points[q][at(j)];
      derivative[at(j)] = 4 * sample_points[q][at(i)];
      for (std::size_t a = 0; a < 3; ++a) slope[q][e][a] = derivative[a + 1] - derivative[0];
    }
  return slope;
}
constexpr auto slopes = make_slopes();

Vec3 combine(const std::array<double, 3>& factor, const JacobianRows& rows) {
  return factor[0] * rows[0] + factor[1] * rows[1] + factor[2] * rows[2];
}

/// Row a of a symmetric matrix.
std::array<double, 3> row_of(const Symmetric3& m, std::size_t a) {
  return a == 0 ? std::array{m[0], m[1], m[2]} : a == 1 ? std::array{m[1], m[3], m[4]} : std::array{m[2], m[4], m[5]};
}

JacobianRows product(const Symmetric3& m, const JacobianRows& rows) {
  return {combine(row_of(m, 0), rows), combine(row_of(m, 1), rows), combine(row_of(m, 2), rows)};
}

double inner(const JacobianRows& a, const JacobianRows& b) {
  return dot(a[0], b[0]) + dot(a[1], b[1]) + dot(a[2], b[2]);
}

JacobianRows cofactors(const JacobianRows& row) {
  return {cross(row[1], row[2]), cross(row[2], row[0]), cross(row[0], row[1])};
}

/// The map at a sample point.
struct AtPoint {
  JacobianRows cofactor;                    ///< derivative of `determinant` by the rows
  double determinant = 0;                   ///< over that of the straight cell
  std::array<JacobianRows, 2> metric_rows;  ///< against each target half the derivative of the squared size by the rows
  std::array<double, 2> squared_size{};     ///< against each target
};

AtPoint at_point(const StraightCell& cell, const CellBulges& bulge, const SampledRows* residual, std::size_t q) {
  auto row = cell.row;
  for (std::size_t e = 0; e < 6; ++e)
    for (std::size_t a = 0; a < 3; ++a) row[a] += slopes[q][e][a] * bulge[e];
  if (residual != nullptr)
    for (std::size_t a = 0; a < 3; ++a) row[a] += (*residual)[q][a];
  AtPoint point;
  point.cofactor = cofactors(row);
  for (auto& c : point.cofactor) c = cell.inverse_determinant * c;
  point.determinant = dot(row[0], point.cofactor[0]);
  for (std::size_t k = 0; k < 2; ++k) {
    point.metric_rows[k] = product(cell.metric[k], row);
    point.squared_size[k] = inner(row, point.metric_rows[k]);
  }
  return point;
}

/// d^2 + 4 delta^2, with d the determinant, is the square of `radius`; `height` is h(d), positive for every d.
struct Regularized {
  double radius = 0, height = 0;
};

Regularized regularize(double determinant, double delta) {
  const double radius = std::sqrt(determinant * determinant + 4 * delta * delta);
  return {radius, determinant > 0 ? 0.5 * (determinant + radius) : 2 * delta * delta / (radius - determinant)};
}

double cube(double x) { return x * x * x; }

/// `size_cubed`: factor n^3, n the squared size.
double energy_at(double size_cubed, double height, int exponent) {
  const double eta_cubed = size_cubed / (height * height);
  double energy = eta_cubed;
  for (int i = 1; i < exponent; ++i) energy *= eta_cubed;
  return energy;
}

/// First and second derivatives of the energy at a point by the squared sizes n and by the determinant d.
struct Derivatives {
  std::array<double, 2> n{}, nn{}, nd{};
  double d = 0, dd = 0;
};

/// With E = (factor n^3 / h^2)^m and h' = h / r, r the radius. The term of d^2 is at least what makes the form positive
/// definite in the rows and d together: 24 m^3 / (6 m - 1) E / r^2.
Derivatives differentiate(const StraightCell& cell, const AtPoint& point, const Distortion& distortion,
                          double& energy) {
  const auto [radius, height] = regularize(point.determinant, distortion.delta);
  const double m = distortion.exponent;
  const double along = std::max(4 * m * m + 2 * m * point.determinant / radius, 24 * m * m * m / (6 * m - 1));
  Derivatives of;
  for (std::size_t k = 0; k < 2; ++k) {
    const double n = point.squared_size[k], e = energy_at(cell.factor[k] * cube(n), height, distortion.exponent);
    energy += e;
    of.n[k] = 3 * m * e / n;
    of.nn[k] = 3 * m * (3 * m - 1) * e / (n * n);
    of.nd[k] = -6 * m * m * e / (n * radius);
    of.d -= 2 * m * e / radius;
    of.dd += along * e / (radius * radius);
  }
  return of;
}

/// The derivatives `by_row` with respect to the components of the bulges.
Components by_components(const JacobianRows& by_row, std::size_t q, const FreeEdges& free) {
  Components result{};
  for (std::size_t e = 0; e < free.n; ++e) {
    const Vec3 v = combine(slopes[q][free.edge[e]], by_row);
    result[3 * e] = v.x;
    result[3 * e + 1] = v.y;
    result[3 * e + 2] = v.z;
  }
  return result;
}

/// Rows of a matrix for all components; of blocks on and right of the diagonal blocks only.
using Matrix = std::array<Components, 18>;

/// Adds the second derivatives of the squared sizes: equal on the three axes.
void add_curvature_of_sizes(const StraightCell& cell, const Derivatives& of, std::size_t q, const FreeEdges& free,
                            Matrix& hessian) {
  Symmetric3 metric;
  for (std::size_t k = 0; k < 6; ++k) metric[k] = 2 * of.n[0] * cell.metric[0][k] + 2 * of.n[1] * cell.metric[1][k];
  for (std::size_t e = 0; e < free.n; ++e) {
    std::array<double, 3> of_edge{};
    for (std::size_t a = 0; a < 3; ++a) {
      const auto row = row_of(metric, a);
      for (std::size_t b = 0; b < 3; ++b) of_edge[a] += row[b] * slopes[q][free.edge[e]][b];
    }
    for (std::size_t f = e; f < free.n; ++f) {
      const auto& s = slopes[q][free.edge[f]];
      const double value = of_edge[0] * s[0] + of_edge[1] * s[1] + of_edge[2] * s[2];
      for (std::size_t k = 0; k < 3; ++k) hessian[3 * e + k][3 * f + k] += value;
    }
  }
}

/// The sums over the sample points so far.
struct Sums {
  Components gradient{};
  Matrix hessian{};
};

void add_point(const StraightCell& cell, const AtPoint& point, const Derivatives& of, std::size_t q,
               const FreeEdges& free, Sums& sums) {
  auto& [gradient, hessian] = sums;
  const auto a = by_components(point.metric_rows[0], q, free), b = by_components(point.metric_rows[1], q, free),
             c = by_components(point.cofactor, q, free);
  const auto n_components = 3 * free.n;
  Components for_a, for_b, for_c;
  for (std::size_t i = 0; i < n_components; ++i) {
    gradient[i] += 2 * of.n[0] * a[i] + 2 * of.n[1] * b[i] + of.d * c[i];
    for_a[i] = 4 * of.nn[0] * a[i] + 2 * of.nd[0] * c[i];
    for_b[i] = 4 * of.nn[1] * b[i] + 2 * of.nd[1] * c[i];
    for_c[i] = 2 * of.nd[0] * a[i] + 2 * of.nd[1] * b[i] + of.dd * c[i];
  }
  for (std::size_t i = 0; i < n_components; ++i)
    for (std::size_t j = i / 3 * 3; j < n_components; ++j)
      hessian[i][j] += for_a[i] * a[j] + for_b[i] * b[j] + for_c[i] * c[j];
  add_curvature_of_sizes(cell, of, q, free, hessian);
}

}  // namespace

StraightCell prepare(const geometry::TetPoints& corner) {
  StraightCell cell;
  for (std::size_t a = 0; a < 3; ++a) cell.row[a] = corner[a + 1] - corner[0];
  const auto cofactor = cofactors(cell.row);
  const double determinant = dot(cofactor[0], cell.row[0]), squared = determinant * determinant;
  cell.inverse_determinant = 1 / determinant;
  // Unit edges of the regular cell have scalar products 1 and 1/2, the inverse of that matrix has 3/2 and -1/2, and the
  // determinant is 1 / sqrt(2). Taking no cube root of it keeps the bits the same on every machine.
  constexpr double on = 1.0 / 2, off = -1.0 / 6;
  cell.metric[0] = {on, off, off, on, off, on};
  cell.factor = {1 / (2 * squared), 1};
  const auto& c = cofactor;
  cell.metric[1] = {dot(c[0], c[0]), dot(c[0], c[1]), dot(c[0], c[2]),
                    dot(c[1], c[1]), dot(c[1], c[2]), dot(c[2], c[2])};
  for (auto& m : cell.metric[1]) m /= 3 * squared;
  cell.mean_ratio = std::cbrt(1 / (cell.factor[0] * cube(inner(cell.row, product(cell.metric[0], cell.row)))));
  return cell;
}

double bulge_energy(const StraightCell& cell, const CellBulges& bulge, const SampledRows* residual,
                    const Distortion& distortion) {
  double energy = 0;
  for (std::size_t q = 0; q < sample_points.size(); ++q) {
    const auto point = at_point(cell, bulge, residual, q);
    const double height = regularize(point.determinant, distortion.delta).height;
    for (std::size_t k = 0; k < 2; ++k)
      energy += energy_at(cell.factor[k] * cube(point.squared_size[k]), height, distortion.exponent);
  }
  return energy;
}

BulgeModel bulge_model(const StraightCell& cell, const CellBulges& bulge, const SampledRows* residual,
                       const Distortion& distortion, unsigned is_free) {
  const FreeEdges free(is_free);
  BulgeModel model;
  Sums sums;
  for (std::size_t q = 0; q < sample_points.size(); ++q) {
    const auto point = at_point(cell, bulge, residual, q);
    const auto derivatives = differentiate(cell, point, distortion, model.energy);
    add_point(cell, point, derivatives, q, free, sums);
  }
  const auto& [gradient, hessian] = sums;
  for (std::size_t e = 0; e < free.n; ++e)
    model.gradient[free.edge[e]] = {gradient[3 * e], gradient[3 * e + 1], gradient[3 * e + 2]};
  auto next = model.hessian.begin();
  for (std::size_t i = 0; i < 3 * free.n; ++i)
    next = std::copy(hessian[i].begin() + static_cast<std::ptrdiff_t>(i),
                     hessian[i].begin() + static_cast<std::ptrdiff_t>(3 * free.n), next);
  return model;
}

double smallest_mean_ratio(const StraightCell& cell, const CellBulges& bulge, const SampledRows* residual) {
  double smallest = std::numeric_limits<double>::infinity();  // cube of the mean ratio, with its sign
  for (std::size_t q = 0; q < sample_points.size(); ++q) {
    const auto point = at_point(cell, bulge, residual, q);
    const double d = point.determinant, n = point.squared_size[0];
    smallest = std::min(smallest, n > 0 ? std::copysign(d * d / (cell.factor[0] * cube(n)), d) : 0);
  }
  return std::cbrt(smallest);
}

}  // namespace pamr::curved
