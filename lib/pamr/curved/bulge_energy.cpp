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

constexpr std::size_t n_points = sample_points.size();

/// A number at every sample point: sums and products of these take several points at a time.
using AtPoints = std::array<double, n_points>;
using VectorAtPoints = std::array<AtPoints, 3>;      ///< by axis
using RowsAtPoints = std::array<VectorAtPoints, 3>;  ///< by row

/// `slopes[e][a][q]`: what a unit bulge of edge e adds to row a at sample point q.
constexpr auto make_slopes() {
  std::array<std::array<AtPoints, 3>, 6> slope{};
  for (std::size_t q = 0; q < n_points; ++q)
    for (std::size_t e = 0; e < 6; ++e) {
      const auto [i, j] = mesh::tet::edge_to_corner[e];
      std::array<double, 4> derivative{};  // of 4 l_i l_j
      derivative[at(i)] = 4 * sample_points[q][at(j)];
      derivative[at(j)] = 4 * sample_points[q][at(i)];
      for (std::size_t a = 0; a < 3; ++a) slope[e][a][q] = derivative[a + 1] - derivative[0];
    }
  return slope;
}
constexpr auto slopes = make_slopes();

/// A number for each of some edges, in the front; the rest counts for nothing.
template <std::size_t width>
using AtEdges = std::array<double, width>;
/// `slopes` of some edges at a point, by row.
template <std::size_t width>
using SlopesAtPoint = std::array<AtEdges<width>, 3>;

/// The edges whose bulges are free, ascending.
struct FreeEdges {
  explicit FreeEdges(unsigned is_free) {
    for (unsigned rest = is_free; rest != 0; rest &= rest - 1) edge[n++] = at(std::countr_zero(rest));
  }
  template <std::size_t width>
  std::array<SlopesAtPoint<width>, n_points> slopes_by_point() const {
    std::array<SlopesAtPoint<width>, n_points> result{};
    for (std::size_t q = 0; q < n_points; ++q)
      for (std::size_t a = 0; a < 3; ++a)
        for (std::size_t e = 0; e < n; ++e) result[q][a][e] = slopes[edge[e]][a][q];
    return result;
  }
  std::array<std::size_t, 6> edge{};
  std::size_t n = 0;
};

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

/// The map at the sample points.
struct Sampled {
  RowsAtPoints cofactor;                    ///< derivatives of `determinant` by the rows
  AtPoints determinant;                     ///< over that of the straight cell
  std::array<RowsAtPoints, 2> metric_rows;  ///< against each target half the derivative of the squared size by the rows
  std::array<AtPoints, 2> squared_size;     ///< against each target
};

/// factor (a b - c d)
AtPoints difference_of_products(double factor, const AtPoints& a, const AtPoints& b, const AtPoints& c,
                                const AtPoints& d) {
  AtPoints result;
  for (std::size_t q = 0; q < n_points; ++q) result[q] = factor * (a[q] * b[q] - c[q] * d[q]);
  return result;
}

AtPoints dot_at_points(const VectorAtPoints& a, const VectorAtPoints& b) {
  AtPoints result;
  for (std::size_t q = 0; q < n_points; ++q) result[q] = a[0][q] * b[0][q] + a[1][q] * b[1][q] + a[2][q] * b[2][q];
  return result;
}

RowsAtPoints rows_of(const StraightCell& cell, const CellBulges& bulge, const SampledRows* residual) {
  RowsAtPoints rows;
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t k = 0; k < 3; ++k) {
      auto& row = rows[a][k];
      row.fill(cell.row[a][k]);
      for (std::size_t e = 0; e < 6; ++e)
        for (std::size_t q = 0; q < n_points; ++q) row[q] += slopes[e][a][q] * bulge[e][k];
      if (residual == nullptr) continue;
      for (std::size_t q = 0; q < n_points; ++q) row[q] += (*residual)[q][a][k];
    }
  return rows;
}

Sampled at_sample_points(const StraightCell& cell, const CellBulges& bulge, const SampledRows* residual) {
  Sampled sampled;
  const auto rows = rows_of(cell, bulge, residual);
  for (std::size_t a = 0; a < 3; ++a)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto &b = rows[(a + 1) % 3], &c = rows[(a + 2) % 3];
      const auto k1 = (k + 1) % 3, k2 = (k + 2) % 3;
      sampled.cofactor[a][k] = difference_of_products(cell.inverse_determinant, b[k1], c[k2], b[k2], c[k1]);
    }
  sampled.determinant = dot_at_points(rows[0], sampled.cofactor[0]);
  for (std::size_t t = 0; t < 2; ++t) {
    auto& metric_rows = sampled.metric_rows[t];
    for (std::size_t a = 0; a < 3; ++a) {
      const auto m = row_of(cell.metric[t], a);
      for (std::size_t k = 0; k < 3; ++k)
        for (std::size_t q = 0; q < n_points; ++q)
          metric_rows[a][k][q] = m[0] * rows[0][k][q] + m[1] * rows[1][k][q] + m[2] * rows[2][k][q];
    }
    const auto x = dot_at_points(rows[0], metric_rows[0]), y = dot_at_points(rows[1], metric_rows[1]),
               z = dot_at_points(rows[2], metric_rows[2]);
    for (std::size_t q = 0; q < n_points; ++q) sampled.squared_size[t][q] = x[q] + y[q] + z[q];
  }
  return sampled;
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
Derivatives differentiate(const StraightCell& cell, const Sampled& sampled, std::size_t q, const Distortion& distortion,
                          double& energy) {
  const double determinant = sampled.determinant[q];
  const auto [radius, height] = regularize(determinant, distortion.delta);
  const double m = distortion.exponent;
  const double along = std::max(4 * m * m + 2 * m * determinant / radius, 24 * m * m * m / (6 * m - 1));
  Derivatives of;
  for (std::size_t k = 0; k < 2; ++k) {
    const double n = sampled.squared_size[k][q], e = energy_at(cell.factor[k] * cube(n), height, distortion.exponent);
    energy += e;
    of.n[k] = 3 * m * e / n;
    of.nn[k] = 3 * m * (3 * m - 1) * e / (n * n);
    of.nd[k] = -6 * m * m * e / (n * radius);
    of.d -= 2 * m * e / radius;
    of.dd += along * e / (radius * radius);
  }
  return of;
}

/// A number for each component of the bulges of some edges, by axis.
template <std::size_t width>
using Components = std::array<AtEdges<width>, 3>;

/// The sums over the sample points so far.
template <std::size_t width>
struct Sums {
  Components<width> gradient{};
  /// By edge and axis; only those from the same edge on count.
  std::array<std::array<Components<width>, 3>, width> hessian{};
};

/// The derivatives `by_row` at a point with respect to the components of the bulges.
template <std::size_t width>
Components<width> by_components(const RowsAtPoints& by_row, std::size_t q, const SlopesAtPoint<width>& slope) {
  Components<width> result;
  for (std::size_t k = 0; k < 3; ++k) {
    const double x = by_row[0][k][q], y = by_row[1][k][q], z = by_row[2][k][q];
    for (std::size_t e = 0; e < width; ++e) result[k][e] = slope[0][e] * x + slope[1][e] * y + slope[2][e] * z;
  }
  return result;
}

/// Edges taken together; a group begins at a multiple of this.
constexpr std::size_t n_together = 4;

/// Adds the second derivatives of the squared sizes: equal on the three axes.
template <std::size_t width>
void add_curvature_of_sizes(const StraightCell& cell, const Derivatives& of, std::size_t n_edges,
                            const SlopesAtPoint<width>& slope, Sums<width>& sums) {
  Symmetric3 metric;
  for (std::size_t k = 0; k < 6; ++k) metric[k] = 2 * of.n[0] * cell.metric[0][k] + 2 * of.n[1] * cell.metric[1][k];
  std::array<AtEdges<width>, 3> of_edge;
  for (std::size_t a = 0; a < 3; ++a) {
    const auto row = row_of(metric, a);
    for (std::size_t e = 0; e < width; ++e)
      of_edge[a][e] = 0.0 + row[0] * slope[0][e] + row[1] * slope[1][e] + row[2] * slope[2][e];
  }
  for (std::size_t e = 0; e < n_edges; ++e)
    for (std::size_t f = e / n_together * n_together; f < width; ++f) {
      const double value = of_edge[0][e] * slope[0][f] + of_edge[1][e] * slope[1][f] + of_edge[2][e] * slope[2][f];
      for (std::size_t k = 0; k < 3; ++k) sums.hessian[e][k][k][f] += value;
    }
}

template <std::size_t width>
void add_point(const StraightCell& cell, const Sampled& sampled, const Derivatives& of, std::size_t q,
               std::size_t n_edges, const SlopesAtPoint<width>& slope, Sums<width>& sums) {
  const auto a = by_components<width>(sampled.metric_rows[0], q, slope),
             b = by_components<width>(sampled.metric_rows[1], q, slope),
             c = by_components<width>(sampled.cofactor, q, slope);
  Components<width> for_a, for_b, for_c;
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t e = 0; e < width; ++e) {
      sums.gradient[k][e] += 2 * of.n[0] * a[k][e] + 2 * of.n[1] * b[k][e] + of.d * c[k][e];
      for_a[k][e] = 4 * of.nn[0] * a[k][e] + 2 * of.nd[0] * c[k][e];
      for_b[k][e] = 4 * of.nn[1] * b[k][e] + 2 * of.nd[1] * c[k][e];
      for_c[k][e] = 2 * of.nd[0] * a[k][e] + 2 * of.nd[1] * b[k][e] + of.dd * c[k][e];
    }
  for (std::size_t e = 0; e < n_edges; ++e)
    for (std::size_t k = 0; k < 3; ++k) {
      const double x = for_a[k][e], y = for_b[k][e], z = for_c[k][e];
      for (std::size_t l = 0; l < 3; ++l)
        for (std::size_t f = e / n_together * n_together; f < width; ++f)
          sums.hessian[e][k][l][f] += x * a[l][f] + y * b[l][f] + z * c[l][f];
    }
  add_curvature_of_sizes<width>(cell, of, n_edges, slope, sums);
}

template <std::size_t width>
void add_points(const StraightCell& cell, const Sampled& sampled, const Distortion& distortion, const FreeEdges& free,
                BulgeModel& model) {
  const auto slope = free.slopes_by_point<width>();
  Sums<width> sums;
  for (std::size_t q = 0; q < n_points; ++q) {
    const auto derivatives = differentiate(cell, sampled, q, distortion, model.energy);
    add_point<width>(cell, sampled, derivatives, q, free.n, slope[q], sums);
  }
  for (std::size_t e = 0; e < free.n; ++e)
    model.gradient[free.edge[e]] = {sums.gradient[0][e], sums.gradient[1][e], sums.gradient[2][e]};
  auto next = model.hessian.begin();
  for (std::size_t e = 0; e < free.n; ++e)
    for (std::size_t k = 0; k < 3; ++k)
      for (std::size_t f = e; f < free.n; ++f)
        for (std::size_t l = f == e ? k : 0; l < 3; ++l) *next++ = sums.hessian[e][k][l][f];
}

BulgeModel model_of(const StraightCell& cell, const CellBulges& bulge, const SampledRows* residual,
                    const Distortion& distortion, unsigned is_free) {
  const FreeEdges free(is_free);
  const auto sampled = at_sample_points(cell, bulge, residual);
  BulgeModel model;
  if (free.n <= n_together)
    add_points<n_together>(cell, sampled, distortion, free, model);
  else
    add_points<2 * n_together>(cell, sampled, distortion, free, model);
  return model;
}

#if defined(__x86_64__) && defined(__GNUC__)
/// The same operations, thus the same bits, in two thirds of the time, on processors that take four numbers at once.
[[gnu::flatten, gnu::target("avx2")]] BulgeModel model_by_fours(const StraightCell& cell, const CellBulges& bulge,
                                                                const SampledRows* residual,
                                                                const Distortion& distortion, unsigned is_free) {
  return model_of(cell, bulge, residual, distortion, is_free);
}

auto choose_model() {
  __builtin_cpu_init();
  return __builtin_cpu_supports("avx2") != 0 ? model_by_fours : bulge_model_anywhere;
}
#else
auto choose_model() { return bulge_model_anywhere; }
#endif

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
  const auto sampled = at_sample_points(cell, bulge, residual);
  double energy = 0;
  for (std::size_t q = 0; q < n_points; ++q) {
    const double height = regularize(sampled.determinant[q], distortion.delta).height;
    for (std::size_t k = 0; k < 2; ++k)
      energy += energy_at(cell.factor[k] * cube(sampled.squared_size[k][q]), height, distortion.exponent);
  }
  return energy;
}

[[gnu::flatten]] BulgeModel bulge_model_anywhere(const StraightCell& cell, const CellBulges& bulge,
                                                 const SampledRows* residual, const Distortion& distortion,
                                                 unsigned is_free) {
  return model_of(cell, bulge, residual, distortion, is_free);
}

BulgeModel bulge_model(const StraightCell& cell, const CellBulges& bulge, const SampledRows* residual,
                       const Distortion& distortion, unsigned is_free) {
  static const auto find_model = choose_model();
  return find_model(cell, bulge, residual, distortion, is_free);
}

double smallest_mean_ratio(const StraightCell& cell, const CellBulges& bulge, const SampledRows* residual) {
  const auto sampled = at_sample_points(cell, bulge, residual);
  double smallest = std::numeric_limits<double>::infinity();  // cube of the mean ratio, with its sign
  for (std::size_t q = 0; q < n_points; ++q) {
    const double d = sampled.determinant[q], n = sampled.squared_size[0][q];
    smallest = std::min(smallest, n > 0 ? std::copysign(d * d / (cell.factor[0] * cube(n)), d) : 0);
  }
  return std::cbrt(smallest);
}

}  // namespace pamr::curved
