// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/quadric.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pamr/base/error.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/geometry/symmetric_eigen.hpp"

namespace pamr::geometry {

namespace {

using Row = std::array<double, 3>;
using Matrix = SquareMatrix<3>;

constexpr double vanishing = 1e-13;  ///< relative to the largest eigenvalue: no square in that direction

/// The polynomial along the critical points y_i = from_i / (1 + t square_i), y_j = from_j - t linear_j / 2, with the
/// multiplier written as t = base + sign s, s >= 0, so that denominators near their pole are exact.
struct Secular {
  Row square, linear, from;
  double constant = 0, base = 0, sign = 1;

  double denominator(std::size_t i, double s) const {
    const double at_base = 1 + base * square[i];
    // at a pole the base is -1 / square: exactly zero there
    return (is_pole(i) ? 0.0 : at_base) + sign * s * square[i];
  }
  bool is_pole(std::size_t i) const { return base != 0 && square[i] != 0 && base == -1 / square[i]; }

  double place(std::size_t i, double s) const {
    if (square[i] == 0) return from[i] - 0.5 * (base + sign * s) * linear[i];
    return from[i] == 0 ? 0.0 : from[i] / denominator(i, s);
  }
  double value(double s) const {
    double sum = constant;
    for (std::size_t i = 0; i < 3; ++i) {
      const double y = place(i, s);
      sum += square[i] == 0 ? linear[i] * y : square[i] * y * y;
    }
    return sum;
  }
  double slope(double s) const {
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const double y = place(i, s);
      sum -= square[i] == 0 ? 0.5 * linear[i] * linear[i]
                            : (from[i] == 0 ? 0.0 : 2 * square[i] * square[i] * y * y / denominator(i, s));
    }
    return sign * sum;
  }
};

/// Root of the secular function between `low` and `high`, at which its values have different signs; it is monotone.
double solve(const Secular& f, double low, double high) {
  const bool is_positive_low = f.sign < 0 ? false : true;  // falls in t, so it falls in s where t grows with s
  double s = 0.5 * (low + high);
  for (int iteration = 0; iteration < 300; ++iteration) {
    const double value = f.value(s);
    if (value == 0) return s;
    ((value > 0) == is_positive_low ? low : high) = s;
    const double newton = s - value / f.slope(s);
    const bool is_inside = low < newton && newton < high;
    // where the bracket spans many orders of magnitude, halve the order
    const double middle = low > 0 && high > 4 * low ? std::sqrt(low) * std::sqrt(high) : 0.5 * (low + high);
    const double next = is_inside && iteration % 4 != 3 ? newton : middle;
    if (!(low < next && next < high) || std::abs(next - s) <= 1e-16 * s) return next;
    s = next;
  }
  return s;
}

}  // namespace

Quadric::Quadric(const std::array<double, 10>& coefficient) {
  for (const double c : coefficient)
    if (!std::isfinite(c)) throw Error("coefficients: expected finite numbers, found " + decimal(c));
  const auto& [xx, yy, zz, xy, yz, zx, x, y, z, one] = coefficient;
  Matrix a{Row{xx, 0.5 * xy, 0.5 * zx}, Row{0.5 * xy, yy, 0.5 * yz}, Row{0.5 * zx, 0.5 * yz, zz}};
  axis_ = diagonalize<3>(a);
  const double largest = std::max({std::abs(a[0][0]), std::abs(a[1][1]), std::abs(a[2][2])});
  if (largest == 0) throw Error("coefficients: expected a square or a product of coordinates, found none");

  const Row b{x, y, z};
  constant_ = one;
  double weight = std::abs(one);
  for (std::size_t i = 0; i < 3; ++i) {
    square_[i] = std::abs(a[i][i]) <= vanishing * largest ? 0.0 : a[i][i];
    const double along = axis_[0][i] * b[0] + axis_[1][i] * b[1] + axis_[2][i] * b[2];
    if (square_[i] == 0) {
      linear_[i] = along;
      continue;
    }
    center_[i] = -along / (2 * square_[i]);
    constant_ -= square_[i] * center_[i] * center_[i];
    weight = std::max(weight, std::abs(square_[i] * center_[i] * center_[i]));
  }
  if (std::abs(constant_) <= 1e-15 * weight) constant_ = 0;
  const bool has_linear = linear_[0] != 0 || linear_[1] != 0 || linear_[2] != 0;
  const bool some_positive = *std::max_element(square_.begin(), square_.end()) > 0;
  const bool some_negative = *std::min_element(square_.begin(), square_.end()) < 0;
  if (has_linear || (some_positive && some_negative)) return;
  if ((some_positive && constant_ > 0) || (some_negative && constant_ < 0))
    throw Error("coefficients: expected a polynomial that is zero somewhere, found one that never is");
  if (constant_ == 0)
    throw Error(
        "coefficients: expected a surface, found a polynomial that is zero in a point, a line or a doubled plane");
}

Quadric::Row Quadric::to_principal(Vec3 point) const {
  Row place{};
  for (std::size_t i = 0; i < 3; ++i)
    place[i] = axis_[0][i] * point.x + axis_[1][i] * point.y + axis_[2][i] * point.z - center_[i];
  return place;
}

Vec3 Quadric::from_principal(const Row& place) const {
  const auto along = [&](std::size_t k) {
    double sum = 0;
    for (std::size_t i = 0; i < 3; ++i) sum += axis_[k][i] * (place[i] + center_[i]);
    return sum;
  };
  return {along(0), along(1), along(2)};
}

double Quadric::value(const Row& place) const {
  double sum = constant_;
  for (std::size_t i = 0; i < 3; ++i) sum += (square_[i] * place[i] + linear_[i]) * place[i];
  return sum;
}

Quadric::Row Quadric::gradient(const Row& place) const {
  Row g{};
  for (std::size_t i = 0; i < 3; ++i) g[i] = 2 * square_[i] * place[i] + linear_[i];
  return g;
}

/// Newton steps along the gradient, which take away what rounding has left.
Quadric::Row Quadric::polished(Row place) const {
  for (int step = 0; step < 2; ++step) {
    const Row g = gradient(place);
    const double squared = g[0] * g[0] + g[1] * g[1] + g[2] * g[2];
    const double off = value(place);
    if (!(squared > 0) || off == 0) break;
    for (std::size_t i = 0; i < 3; ++i) place[i] -= off / squared * g[i];
  }
  return place;
}

Quadric::Row Quadric::nearest(const Row& from) const {
  const double here = value(from);
  if (here == 0) return from;
  // outside (positive) the multiplier grows from 0 up to the pole of the least square, inside it falls
  const double extreme =
      here > 0 ? *std::min_element(square_.begin(), square_.end()) : *std::max_element(square_.begin(), square_.end());
  const bool has_pole = here > 0 ? extreme < 0 : extreme > 0;
  Secular f{square_, linear_, from, constant_, has_pole ? -1 / extreme : 0.0, 1};
  double low = 0, high = 0;
  if (has_pole) {
    f.sign = here > 0 ? -1 : 1;
    high = std::abs(f.base);
    const double at_pole = f.value(0);  // infinite but for points without a part along the pole's axis
    if (std::isfinite(at_pole) && (at_pole > 0) == (here > 0)) {
      Row place{};
      bool is_free = true;
      for (std::size_t i = 0; i < 3; ++i) {
        place[i] = f.is_pole(i) ? 0.0 : f.place(i, 0);
        if (!f.is_pole(i) || !is_free) continue;
        place[i] = std::sqrt(-at_pole / extreme);
        is_free = false;
      }
      return place;
    }
  } else {
    f.sign = here > 0 ? 1 : -1;
    const double scale = std::max({std::abs(square_[0]), std::abs(square_[1]), std::abs(square_[2])});
    for (high = 1 / scale; (f.value(high) > 0) == (here > 0) && high < 1e150; high *= 4) low = high;
  }
  const double s = solve(f, low, high);
  return {f.place(0, s), f.place(1, s), f.place(2, s)};
}

Vec3 Quadric::project(Vec3 point) const { return from_principal(polished(nearest(to_principal(point)))); }

Vec3 Quadric::normal(Vec3 point) const {
  const Row from = to_principal(point), place = polished(nearest(from));
  Row g = gradient(place);
  double length = std::hypot(g[0], g[1], g[2]);
  if (!(length > min_length)) {  // a tip: away from it
    for (std::size_t i = 0; i < 3; ++i) g[i] = from[i] - place[i];
    length = std::hypot(g[0], g[1], g[2]);
    if (!(length > min_length)) g = {0, 0, length = 1};
    if (value(from) < 0) length = -length;
  }
  const auto along = [&](std::size_t k) {
    return (axis_[k][0] * g[0] + axis_[k][1] * g[1] + axis_[k][2] * g[2]) / length;
  };
  return {along(0), along(1), along(2)};
}

double Quadric::magnitude() const {
  double least = std::numeric_limits<double>::infinity(), linear = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    if (square_[i] != 0) least = std::min(least, std::abs(square_[i]));
    linear = std::max(linear, std::abs(linear_[i]));
  }
  return largest_coordinate(from_principal({0, 0, 0})) + std::sqrt(std::abs(constant_) / least) + linear / least;
}

}  // namespace pamr::geometry
