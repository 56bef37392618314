// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/quadratic_tet.hpp"

#include <CGAL/MP_Float.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <utility>
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

/// Bounds of the entries of each derivative.
std::array<double, 3> bounds_of_entries(const QuadraticTet& tet) {
  std::array<double, 3> bound{};
  for (std::size_t k = 1; k < 4; ++k)
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t axis = 0; axis < 3; ++axis)
        bound[k - 1] = std::max(bound[k - 1], 4 * std::abs(tet[i][k][axis] - tet[i][0][axis]) +
                                                  std::abs(tet[k][k][axis] - tet[0][0][axis]));
  return bound;
}

/// Their product: no determinant of three derivatives exceeds six times this.
double scale_of(const QuadraticTet& tet) {
  const auto bound = bounds_of_entries(tet);
  return bound[0] * bound[1] * bound[2];
}

// With u = 2^-53 and N the scale: entries of the derivatives have errors of at most 2 u times their bound, so that the
// determinants of the rounded entries are off by 36 u N; the arithmetic of a determinant adds 36 u N, its part of the
// sum 30 u N and the division 12 u N. Halving an edge replaces coefficients, which do not exceed 6 N, by means of at
// most eight of them: 42 u N. The constants below are larger, for the terms of higher order and for the rounding of N.
constexpr double error_at_first = 0x1p-45;  ///< 256 u
constexpr double error_of_halving = 0x1p-47;
constexpr double error_of_entries = 0x1p-42;  ///< of their bound, after any number of halvings
constexpr double underflow = 1e-300;          ///< covers products that underflow
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

double lower_bound(const Piece& piece) {
  return *std::min_element(piece.coefficient.begin(), piece.coefficient.end()) - piece.error;
}
/// At a corner the coefficient is the value of the determinant.
double at_corner(const Piece& piece, std::size_t i) { return piece.coefficient[coefficient_of[i][i][i]]; }

/// A piece with the derivatives at its corners.
struct ShapedPiece {
  Piece piece;
  Derivatives<double> along{};
};

ShapedPiece half_of(const ShapedPiece& whole, std::size_t kept, std::size_t gone, double scale) {
  ShapedPiece half{half_of(whole.piece, kept, gone, scale), whole.along};
  for (auto& derivative : half.along)
    for (std::size_t axis = 0; axis < 3; ++axis)
      derivative[gone][axis] = 0.5 * (derivative[gone][axis] + derivative[kept][axis]);
  return half;
}

/// Sum of the squared edges of the tetrahedron that the Jacobian at a corner makes, where each entry of the derivatives
/// may be off by so much; not less than the true one.
double squared_size(const Derivatives<double>& along, std::size_t corner, double error) {
  double sum = 0;
  const auto add = [&](double entry, double off) { sum += (std::abs(entry) + off) * (std::abs(entry) + off); };
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (std::size_t k = 0; k < 3; ++k) {
      add(along[k][corner][axis], error);
      add(along[(k + 1) % 3][corner][axis] - along[k][corner][axis], 2 * error);
    }
  return sum;
}

/// Third power of the root of the mean ratio of a tetrahedron, of the sign of the determinant; `size`: third power of
/// the root of the sum of its squared edges.
double shape_of(double determinant, double size) { return 12 * std::sqrt(3.0) * determinant / size; }

double three_halves(double x) { return x * std::sqrt(x); }

/// A lower bound of `shape_of` in a piece, -infinity if the determinant may not be positive. The squares of the edges
/// are convex, and so is their power 3/2: it lies below the linear function that has its values at the corners. The
/// Bezier coefficients of that are means of three values.
double bound_shape(const ShapedPiece& part, double error) {
  std::array<double, 4> size{};
  for (std::size_t i = 0; i < 4; ++i) size[i] = three_halves(squared_size(part.along, i, error));
  double bound = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < 4; ++i)
    for (std::size_t j = i; j < 4; ++j)
      for (std::size_t k = j; k < 4; ++k) {
        const double determinant = part.piece.coefficient[coefficient_of[i][j][k]] - part.piece.error;
        if (!(determinant > 0)) return -std::numeric_limits<double>::infinity();
        bound = std::min(bound, shape_of(determinant, (size[i] + size[j] + size[k]) / 3));
      }
  return bound;
}

/// Cuts the piece with the smallest lower bound until that is close to a value at a corner. `bound_of`: of a piece;
/// `value_at`: at a corner of one.
template <class Bound, class Value>
LowerBound bound_closely(const ShapedPiece& whole, double scale, double tolerance, Bound&& bound_of, Value&& value_at) {
  using Entry = std::pair<double, std::size_t>;  // lower bound and place of a piece
  std::vector<ShapedPiece> piece;
  std::vector<Entry> open;
  double smallest = std::numeric_limits<double>::infinity();
  LowerBound bound;
  const auto add = [&](const ShapedPiece& part, std::size_t place) {
    for (std::size_t i = 0; i < 4; ++i)
      if (const double value = value_at(part, i); value < smallest) {
        smallest = value;
        bound.near = part.piece.corner[i];
      }
    open.emplace_back(bound_of(part), place);
    std::push_heap(open.begin(), open.end(), std::greater<>());
  };
  piece.push_back(whole);
  for (add(whole, 0);; add(piece.back(), piece.size() - 1)) {
    bound.value = open.front().first;
    if (smallest <= 0 || bound.value >= (1 - tolerance) * smallest || piece.size() == max_pieces) return bound;
    std::pop_heap(open.begin(), open.end(), std::greater<>());
    const auto place = open.back().second;
    open.pop_back();
    const auto part = piece[place];
    const auto [a, b] = longest_edge(part.piece);
    piece[place] = half_of(part, a, b, scale);
    add(piece[place], place);
    piece.push_back(half_of(part, b, a, scale));
  }
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
    const double lower = lower_bound(piece);
    if (suffices(lower)) {
      bound.lower = std::min(bound.lower, lower);
      continue;
    }
    for (std::size_t i = 0; i < 4; ++i)
      if (!suffices(at_corner(piece, i) - piece.error)) return {false, 0, bound.n_pieces};
    if (++bound.n_pieces > max_pieces) return {false, 0, max_pieces};
    const auto [a, b] = longest_edge(piece);
    open.push_back(half_of(piece, a, b, scale));
    open.push_back(half_of(piece, b, a, scale));
  }
  return bound;
}

MapBounds bound_map(const QuadraticTet& tet) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  constexpr double tolerance = 0.01, rounding = 0x1p-45;
  const double scale = scale_of(tet);
  if (!std::isfinite(scale)) return {{-infinity, {}}, {-1, {}}};
  const ShapedPiece whole{whole_of(tet, scale), derivatives_of<double>(tet)};
  const auto entries = bounds_of_entries(tet);
  const double error = error_of_entries * *std::max_element(entries.begin(), entries.end());
  MapBounds bounds;
  bounds.determinant = bound_closely(
      whole, scale, tolerance, [](const ShapedPiece& p) { return lower_bound(p.piece); },
      [](const ShapedPiece& p, std::size_t i) { return at_corner(p.piece, i); });
  bounds.mean_ratio = bound_closely(
      whole, scale, 1.5 * tolerance, [&](const ShapedPiece& p) { return bound_shape(p, error); },
      [](const ShapedPiece& p, std::size_t i) {
        return shape_of(at_corner(p.piece, i), three_halves(squared_size(p.along, i, 0)));
      });
  auto& ratio = bounds.mean_ratio.value;
  ratio = ratio > 0 ? (1 - rounding) * std::cbrt(ratio * ratio) : -1;
  return bounds;
}

bool is_positive_exactly(const QuadraticTet& tet) {
  for (const auto& row : tet)
    for (const auto node : row) PAMR_EXPECTS(is_finite(node));
  const auto coefficient = summed_coefficients(derivatives_of<CGAL::MP_Float>(tet));
  return std::all_of(coefficient.begin(), coefficient.end(), [](const auto& c) { return CGAL::sign(c) > 0; });
}

Vec3 point_at(const QuadraticTet& tet, const std::array<double, 4>& barycentric) {
  Vec3 point;
  for (std::size_t i = 0; i < 4; ++i) {
    point += barycentric[i] * (2 * barycentric[i] - 1) * tet[i][i];
    for (std::size_t j = i + 1; j < 4; ++j) point += 4 * barycentric[i] * barycentric[j] * tet[i][j];
  }
  return point;
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
