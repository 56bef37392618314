// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/fit_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "pamr/geometry/box.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/geometry/shape_starts.hpp"
#include "pamr/geometry/symmetric_eigen.hpp"

namespace pamr::geometry {

namespace {

constexpr std::size_t n_parameters = 7;  // three of the place, two of the axis, two of the size
using Row = std::array<double, n_parameters>;

/// A point as a shape of revolution sees it.
struct FromAxis {
  double along, from_axis;
  Vec3 outward;  ///< unit; of no meaning on the axis
};

FromAxis from_axis_of(const FittedShape& shape, Vec3 unit_axis, Vec3 point) {
  const Vec3 from_place = point - shape.place;
  const double along = dot(from_place, unit_axis);
  const Vec3 across = from_place - along * unit_axis;
  const double distance = norm(across);
  return {along, distance, distance > 0 ? (1 / distance) * across : Vec3{}};
}

/// The distance from the shape and its derivatives by along, from_axis, radius and of_tube.
struct Distance {
  double value, by_along, by_from_axis, by_radius, by_tube;
};

Distance distance(const FittedShape& shape, double x, double r) {
  switch (shape.kind) {
    case ShapeKind::sphere: {
      const double l = std::max(std::hypot(x, r), min_length);
      return {l - shape.radius, x / l, r / l, -1, 0};
    }
    case ShapeKind::cylinder:
      return {r - shape.radius, 0, 1, -1, 0};
    case ShapeKind::cone: {
      const double s = std::sin(shape.radius), c = std::cos(shape.radius);
      return {r * c - x * s, -s, c, -r * s - x * c, 0};
    }
    case ShapeKind::torus: {
      const double l = std::max(std::hypot(r - shape.radius, x), min_length);
      return {l - shape.of_tube, x / l, (r - shape.radius) / l, -(r - shape.radius) / l, -1};
    }
  }
  return {};
}

double sum_of_squares(const FittedShape& shape, std::span<const Vec3> point) {
  double sum = 0;
  for (const auto& p : point) {
    const double d = shape.signed_distance(p);
    sum += d * d;
  }
  return sum;
}

/// Two unit vectors that make a right-handed frame with this one.
std::array<Vec3, 2> across(Vec3 axis) {
  const Vec3 other = std::abs(axis.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0};
  Vec3 first = cross(axis, other);
  first = (1 / norm(first)) * first;
  return {first, cross(axis, first)};
}

/// One least-squares problem, linearized: the matrix diagonalized, and the gradient.
struct Linearized {
  SquareMatrix<n_parameters> matrix{}, vectors{};
  Row gradient{};
  double largest = 0;

  Linearized(const FittedShape& shape, const std::array<Vec3, 2>& tilt, std::span<const Vec3> point) {
    for (const auto& p : point) {
      const auto [x, r, outward] = from_axis_of(shape, shape.axis, p);
      const auto d = distance(shape, x, r);
      const Vec3 by_place = -d.by_along * shape.axis - d.by_from_axis * outward;
      const double turn = d.by_along * r - d.by_from_axis * x;
      const Row row{by_place.x,  by_place.y, by_place.z, turn * dot(outward, tilt[0]), turn * dot(outward, tilt[1]),
                    d.by_radius, d.by_tube};
      for (std::size_t i = 0; i < n_parameters; ++i) {
        gradient[i] += row[i] * d.value;
        for (std::size_t k = 0; k < n_parameters; ++k) matrix[i][k] += row[i] * row[k];
      }
    }
    vectors = diagonalize<n_parameters>(matrix);
    for (std::size_t i = 0; i < n_parameters; ++i) largest = std::max(largest, matrix[i][i]);
  }

  /// Directions that change nothing (along the axis of a cylinder) are left alone.
  Row step(double damping) const {
    constexpr double vanishing = 1e-13;
    Row result{};
    for (std::size_t i = 0; i < n_parameters; ++i) {
      if (!(matrix[i][i] > vanishing * largest)) continue;
      double along = 0;
      for (std::size_t k = 0; k < n_parameters; ++k) along += vectors[k][i] * gradient[k];
      along /= matrix[i][i] + damping * largest;
      for (std::size_t k = 0; k < n_parameters; ++k) result[k] -= along * vectors[k][i];
    }
    return result;
  }
};

FittedShape moved(FittedShape shape, const std::array<Vec3, 2>& tilt, const Row& step) {
  shape.place += Vec3{step[0], step[1], step[2]};
  shape.axis += step[3] * tilt[0] + step[4] * tilt[1];
  shape.axis = (1 / norm(shape.axis)) * shape.axis;
  shape.radius += step[5];
  shape.of_tube += step[6];
  return shape;
}

/// Least squares from a start near by. Source: K. Levenberg 1944, D. W. Marquardt 1963.
FittedShape improve(FittedShape shape, std::span<const Vec3> point, int max_steps) {
  double best = sum_of_squares(shape, point), damping = 1e-3;
  for (int step = 0; step < max_steps && damping < 1e10; ++step) {
    const auto tilt = across(shape.axis);
    const Linearized problem(shape, tilt, point);
    bool is_better = false;
    for (; damping < 1e10 && !is_better; damping *= 10) {
      const auto next = moved(shape, tilt, problem.step(damping));
      const double sum = sum_of_squares(next, point);
      is_better = sum < best;  // false for one that is not finite
      if (!is_better) continue;
      if (sum > (1 - 1e-3) * best && damping < 1e-9) max_steps = step;  // rounding is left
      shape = next;
      best = sum;
    }
    damping = std::max(damping * 1e-3, 1e-16);
  }
  return shape;
}

std::vector<double> distances(const FittedShape& shape, std::span<const Vec3> point) {
  std::vector<double> result;
  for (const auto& p : point) result.push_back(std::abs(shape.signed_distance(p)));
  return result;
}

double worst_of(const FittedShape& shape, std::span<const Vec3> point) {
  double worst = 0;
  for (const double d : distances(shape, point)) worst = std::isfinite(d) ? std::max(worst, d) : HUGE_VAL;
  return worst;
}

/// Fits the three quarters of the points that fit best, where the rest is what keeps them from fitting. Source: P. J.
/// Rousseeuw, K. Van Driessen, "Computing LTS regression for large data sets", Data Min. Knowl. Disc. 12, 2006.
FittedShape without_outliers(const FittedShape& all, std::span<const Vec3> point) {
  constexpr double rounding = 1e-14;
  const std::size_t n_kept = point.size() - point.size() / 4;
  auto shape = all;
  double first = 0, quantile = 0;
  for (int round = 0; round < 10; ++round) {
    const auto off = distances(shape, point);
    std::vector<std::size_t> order(point.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::sort(order.begin(), order.end(), [&](auto i, auto k) { return off[i] != off[k] ? off[i] < off[k] : i < k; });
    quantile = off[order[n_kept - 1]];
    if (round == 0) first = quantile;
    if (quantile <= rounding) break;
    std::vector<Vec3> kept;
    for (std::size_t i = 0; i < n_kept; ++i) kept.push_back(point[order[i]]);
    shape = improve(shape, kept, 20);
  }
  return quantile < 0.1 * first ? shape : all;
}

/// Whether it is one of its kind, in units of the box of the points.
bool is_sound(FittedShape& shape, std::span<const Vec3> point) {
  constexpr double large = 1e3, small = 1e-3;
  if (!is_finite(shape.place) || !(norm(shape.place) < large) || !is_finite(shape.axis)) return false;
  switch (shape.kind) {
    case ShapeKind::sphere:
    case ShapeKind::cylinder:
      return shape.radius > 0 && shape.radius < large;
    case ShapeKind::torus:
      return shape.of_tube > 0 && shape.of_tube < shape.radius && shape.radius < large;
    case ShapeKind::cone:
      shape.radius = std::remainder(shape.radius, 2 * std::numbers::pi);
      if (shape.radius < 0) {
        shape.radius = -shape.radius;
        shape.axis = -shape.axis;
      }
      return shape.radius > small && shape.radius < std::numbers::pi / 2 - small &&
             std::all_of(point.begin(), point.end(), [&](const Vec3& p) {
               return dot(p - shape.place, shape.axis) > -1e-6;  // the other nappe is none of the surface's
             });
  }
  return false;
}

/// Rounds a number to the fewest digits with which the fit is within `allowed`.
template <class Fits>
void shorten(double& value, Fits&& fits) {
  const double exact = value;
  value = 0;
  if (exact == 0 || fits()) return;
  const int top = static_cast<int>(std::floor(std::log10(std::abs(exact)))) + 1;
  for (int digits = 0; digits < 17; ++digits) {
    const int place = digits - top;  // decimals; powers of ten above 10^22 are not exact
    const double unit = std::pow(10.0, std::abs(place));
    value = place >= 0 ? std::round(exact * unit) / unit : std::round(exact / unit) * unit;
    if (fits()) {
      value += 0.0;
      return;
    }
  }
  value = exact;
}

FittedShape with_unit_axis(FittedShape shape) {
  shape.axis = (1 / norm(shape.axis)) * shape.axis;
  return shape;
}

/// The distance that three quarters of the points keep: what rounding must not spoil where a few are farther off.
double usual_distance(const FittedShape& shape, std::span<const Vec3> point) {
  auto off = distances(shape, point);
  for (auto& d : off)
    if (!std::isfinite(d)) d = HUGE_VAL;
  const auto last = off.begin() + static_cast<std::ptrdiff_t>(off.size() - off.size() / 4 - 1);
  std::nth_element(off.begin(), last, off.end());
  return *last;
}

/// The same shape in as few digits as fit the points as well, but for rounding.
FittedShape shortened(const FittedShape& exact, std::span<const Vec3> point, double size) {
  double coordinate = 0;
  for (const auto& p : point) coordinate = std::max(coordinate, largest_coordinate(p));
  const double rounding = 8 * std::numeric_limits<double>::epsilon() * std::max(size, coordinate);
  const double worst = 1.1 * worst_of(exact, point) + rounding, usual = 1.1 * usual_distance(exact, point) + rounding;
  auto shape = exact;
  const auto fits = [&] {
    if (!(norm(shape.axis) > 0.1)) return false;
    const auto now = with_unit_axis(shape);
    return worst_of(now, point) <= worst && usual_distance(now, point) <= usual;
  };
  if (shape.kind != ShapeKind::sphere) {
    shape.axis = (1 / largest_coordinate(shape.axis)) * shape.axis;
    for (std::size_t k = 0; k < 3; ++k) shorten(shape.axis[k], fits);
    const Vec3 a = shape.axis;
    if (shape.kind != ShapeKind::cone && (a.x != 0 ? a.x : a.y != 0 ? a.y : a.z) < 0) shape.axis = Vec3{} - a;
  }
  for (std::size_t k = 0; k < 3; ++k) shorten(shape.place[k], fits);
  if (shape.kind == ShapeKind::cone) {  // written in degrees
    double degrees = shape.radius * 180 / std::numbers::pi;
    shorten(degrees, [&] {
      shape.radius = degrees * std::numbers::pi / 180;
      return fits();
    });
    shape.radius = degrees * std::numbers::pi / 180;
  } else {
    shorten(shape.radius, fits);
  }
  if (shape.kind == ShapeKind::torus) shorten(shape.of_tube, fits);
  return shape;
}

}  // namespace

std::string_view name_of(ShapeKind kind) {
  constexpr std::array<std::string_view, 4> names{"sphere", "cylinder", "cone", "torus"};
  return names[static_cast<std::size_t>(kind)];
}

int n_unknowns(ShapeKind kind) { return 4 + static_cast<int>(kind); }

double FittedShape::signed_distance(Vec3 point) const {
  const auto seen = from_axis_of(*this, axis, point);
  return distance(*this, seen.along, seen.from_axis).value;
}

double FittedShape::curvature(Vec3 point) const {
  if (kind == ShapeKind::torus) return 1 / std::min(of_tube, radius - of_tube);
  if (kind != ShapeKind::cone) return 1 / radius;
  const double from_axis = from_axis_of(*this, (1 / norm(axis)) * axis, point).from_axis;
  return from_axis > 0 ? std::cos(radius) / from_axis : std::numeric_limits<double>::infinity();
}

std::optional<ShapeFit> fit_shape(ShapeKind kind, std::span<const Vec3> point, std::span<const Vec3> normal) {
  constexpr double near = 1e-6, curved = 1e-4, times_flatter = 1e3;
  if (point.size() < 3 * static_cast<std::size_t>(n_unknowns(kind))) return {};
  const auto box = box_of(point);
  const Vec3 center = box.center();
  const double size = box.diagonal();
  if (!(size > 0) || !std::isfinite(size)) return {};
  std::vector<Vec3> local;
  for (const auto& p : point) local.push_back((1 / size) * (p - center));
  const double off_plane = distance_from_plane(local);
  if (off_plane < curved) return {};

  std::optional<FittedShape> best;
  double least = std::numeric_limits<double>::infinity();
  for (const auto& start : shape_starts(kind, local, normal)) {
    auto shape = improve(start, local, 12);
    const double sum = sum_of_squares(shape, local);
    if (!(sum < least)) continue;
    least = sum;
    best = shape;
  }
  if (!best) return {};
  auto shape = without_outliers(improve(*best, local, 60), local);
  if (!is_sound(shape, local)) return {};
  if (kind == ShapeKind::cylinder) shape.place = shape.place - dot(shape.place, shape.axis) * shape.axis;
  const double off = worst_of(shape, local);
  if (off > near || off_plane < times_flatter * off) return {};
  shape.place = center + size * shape.place;
  if (kind != ShapeKind::cone) shape.radius *= size;
  shape.of_tube *= size;
  shape = shortened(shape, point, size);
  return ShapeFit{shape, worst_of(with_unit_axis(shape), point)};
}

DescribedSurface described_shape(const std::string& name, const FittedShape& shape) {
  const auto place = shortest(shape.place), axis = shortest(shape.axis);
  const auto radius = shortest(shape.radius);
  switch (shape.kind) {
    case ShapeKind::sphere:
      return described_sphere(name, place, radius);
    case ShapeKind::cylinder:
      return described_cylinder(name, place, axis, radius);
    case ShapeKind::cone:
      return described_cone(name, place, axis, shortest(shape.radius * 180 / std::numbers::pi));
    case ShapeKind::torus:
      break;
  }
  return described_torus(name, place, axis, radius, shortest(shape.of_tube));
}

}  // namespace pamr::geometry
