// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/quadratic_tet.hpp"

#include <CGAL/MP_Float.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "pamr/base/contract.hpp"

namespace pamr::geometry {

namespace {

/// Values of a homogeneous polynomial of degree 3 in four variables: one for each multiset of three corners.
constexpr std::size_t n_coefficients = 20;
template <class Number>
using Cubic = std::array<Number, n_coefficients>;

/// `coefficient_of[i][j][k]`: the place of the multiset {i, j, k}.
using CoefficientTable = std::array<std::array<std::array<std::size_t, 4>, 4>, 4>;
constexpr CoefficientTable make_coefficient_table() {
  CoefficientTable table{};
  std::size_t next = 0;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i; j < 4; ++j)
      for (std::size_t k = j; k < 4; ++k) {
        table[i][j][k] = table[i][k][j] = table[j][i][k] = table[j][k][i] = table[k][i][j] = table[k][j][i] = next;
        ++next;
      }
  return table;
}
constexpr auto coefficient_of = make_coefficient_table();

/// Of how many ordered triples each multiset is made.
constexpr std::array<int, n_coefficients> make_orderings() {
  std::array<int, n_coefficients> orderings{};
  for (const auto& plane : coefficient_of)
    for (const auto& row : plane)
      for (const auto c : row) ++orderings[c];
  return orderings;
}
constexpr auto orderings = make_orderings();

template <class Number>
using Vector = std::array<Number, 3>;
/// The derivatives along the edges from corner 0: `along[k - 1][i]` is the value at corner i of the one to corner k.
template <class Number>
using Derivatives = std::array<std::array<Vector<Number>, 4>, 3>;

/// The derivative of a quadratic map is linear. In Bezier form its value at corner i is twice the difference of two
/// control points, which in terms of the nodes is 4 (node[i][k] - node[i][0]) - (node[k][k] - node[0][0]).
template <class Number>
Derivatives<Number> derivatives_of(const QuadraticTet& tet) {
  Derivatives<Number> along;
  for (std::size_t k = 1; k < 4; ++k)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        along[k - 1][i][axis] = Number(4.0) * (Number(tet[i][k][axis]) - Number(tet[i][0][axis])) -
                                (Number(tet[k][k][axis]) - Number(tet[0][0][axis]));
  return along;
}

/// The Bezier coefficients of the determinant of the derivatives, each times its number of orderings.
template <class Number>
Cubic<Number> summed_coefficients(const Derivatives<Number>& along) {
  Cubic<Number> sum;
  sum.fill(Number(0.0));
  for (std::size_t j = 0; j < 4; ++j)
    for (std::size_t k = 0; k < 4; ++k) {
      const auto &v = along[1][j], &w = along[2][k];
      const Vector<Number> normal{v[1] * w[2] - v[2] * w[1], v[2] * w[0] - v[0] * w[2], v[0] * w[1] - v[1] * w[0]};
      for (std::size_t i = 0; i < 4; ++i) {
        const auto& u = along[0][i];
        auto& c = sum[coefficient_of[i][j][k]];
        c = c + (u[0] * normal[0] + u[1] * normal[1] + u[2] * normal[2]);
      }
    }
  return sum;
}

/// Product of bounds of the entries of each derivative: no determinant of three of them exceeds six times this.
double scale_of(const QuadraticTet& tet) {
  double scale = 1;
  for (std::size_t k = 1; k < 4; ++k) {
    double largest = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        largest = std::max(
            largest, 4 * std::abs(tet[i][k][axis] - tet[i][0][axis]) + std::abs(tet[k][k][axis] - tet[0][0][axis]));
    scale *= largest;
  }
  return scale;
}

// With u = 2^-53 and N the scale: entries of the derivatives have errors of at most 2 u times their bound, so that the
// determinants of the rounded entries are off by 36 u N; the arithmetic of a determinant adds 36 u N, its part of the
// sum 30 u N and the division 12 u N. Halving an edge replaces coefficients, which do not exceed 6 N, by means of at
// most eight of them: 42 u N. The constants below are larger, for the terms of higher order and for the rounding of N.
constexpr double error_at_first = 0x1p-45;  ///< 256 u
constexpr double error_of_halving = 0x1p-47;
constexpr double underflow = 1e-300;  ///< covers products that underflow
constexpr int max_pieces = 512;

/// A part of the tetrahedron: the coefficients on it, and its corners in barycentric coordinates.
struct Piece {
  Cubic<double> coefficient{};
  std::array<std::array<double, 4>, 4> corner{};
  double error = 0;
};

/// The longest edge in the reference tetrahedron, the first among equals.
std::array<std::size_t, 2> longest_edge(const Piece& piece) {
  std::array<std::size_t, 2> best{0, 1};
  double longest = -1;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i + 1; j < 4; ++j) {
      double length = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        const double d = piece.corner[i][k] - piece.corner[j][k];
        length += d * d;
      }
      if (length > longest) {
        longest = length;
        best = {i, j};
      }
    }
  return best;
}

/// The half of a piece in which the middle of the edge takes the place of corner `gone`. In polar form the coefficient
/// of three corners is linear in each of them.
Piece half_of(const Piece& piece, std::size_t kept, std::size_t gone, double scale) {
  Piece half = piece;
  const auto other = [&](std::size_t corner) { return corner == gone ? kept : corner; };
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i; j < 4; ++j)
      for (std::size_t k = j; k < 4; ++k) {
        if (i != gone && j != gone && k != gone) continue;
        const auto c = [&](std::size_t a, std::size_t b, std::size_t d) {
          return piece.coefficient[coefficient_of[a][b][d]];
        };
        const auto p = other(i), q = other(j), r = other(k);
        half.coefficient[coefficient_of[i][j][k]] = 0.125 * (((c(i, j, k) + c(p, j, k)) + (c(i, q, k) + c(p, q, k))) +
                                                             ((c(i, j, r) + c(p, j, r)) + (c(i, q, r) + c(p, q, r))));
      }
  for (std::size_t k = 0; k < 4; ++k) half.corner[gone][k] = 0.5 * (piece.corner[gone][k] + piece.corner[kept][k]);
  half.error += error_of_halving * scale;
  return half;
}

Piece whole_of(const QuadraticTet& tet, double scale) {
  Piece piece{summed_coefficients(derivatives_of<double>(tet)), {}, error_at_first * scale + underflow * (1 + scale)};
  for (std::size_t c = 0; c < n_coefficients; ++c) piece.coefficient[c] /= orderings[c];
  for (std::size_t i = 0; i < 4; ++i) piece.corner[i][i] = 1;
  return piece;
}

}  // namespace

QuadraticTet straight_tet(const std::array<Vec3, 4>& corner) {
  QuadraticTet tet;
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = 0; j < 4; ++j) tet[i][j] = i == j ? corner[i] : midpoint(corner[i], corner[j]);
  return tet;
}

JacobianBound bound_jacobian(const QuadraticTet& tet, double limit) {
  const double scale = scale_of(tet);
  if (!std::isfinite(scale)) return {};
  const auto suffices = [&](double value) { return value > 0 && value >= limit; };
  JacobianBound bound{true, std::numeric_limits<double>::infinity(), 1};
  std::vector<Piece> open{whole_of(tet, scale)};
  while (!open.empty()) {
    const auto piece = open.back();
    open.pop_back();
    const double lower = *std::min_element(piece.coefficient.begin(), piece.coefficient.end()) - piece.error;
    if (suffices(lower)) {
      bound.lower = std::min(bound.lower, lower);
      continue;
    }
    // at a corner the coefficient is the value of the determinant
    for (std::size_t i = 0; i < 4; ++i)
      if (!suffices(piece.coefficient[coefficient_of[i][i][i]] - piece.error)) return {false, 0, bound.n_pieces};
    if (++bound.n_pieces > max_pieces) return {false, 0, max_pieces};
    const auto [a, b] = longest_edge(piece);
    open.push_back(half_of(piece, a, b, scale));
    open.push_back(half_of(piece, b, a, scale));
  }
  return bound;
}

bool is_positive_exactly(const QuadraticTet& tet) {
  for (const auto& row : tet)
    for (const auto node : row) PAMR_EXPECTS(is_finite(node));
  const auto coefficient = summed_coefficients(derivatives_of<CGAL::MP_Float>(tet));
  return std::all_of(coefficient.begin(), coefficient.end(), [](const auto& c) { return CGAL::sign(c) > 0; });
}

double jacobian_at(const QuadraticTet& tet, const std::array<double, 4>& barycentric) {
  const auto along = derivatives_of<double>(tet);
  std::array<Vec3, 3> edge{};
  for (std::size_t k = 0; k < 3; ++k)
    for (std::size_t i = 0; i < 4; ++i)
      edge[k] += barycentric[i] * Vec3{along[k][i][0], along[k][i][1], along[k][i][2]};
  return dot(edge[0], cross(edge[1], edge[2]));
}

}  // namespace pamr::geometry
