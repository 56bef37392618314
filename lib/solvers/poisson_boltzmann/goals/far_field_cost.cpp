// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/far_field_cost.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/fem/elements.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

/// A part of a far-field wall around a quadrature point.
struct WallPoint {
  Vec3 position, normal;
  double area = 0;
  Vec3 gradient;
  double u = 0, w = 0;  ///< both of u without the profile of the plate
};

template <class Element>
std::vector<WallPoint> far_field_points(const Element& element, const State& state, std::span<const double> w) {
  const auto& problem = state.problem;
  const auto& faces = element.domain.faces;
  std::vector<WallPoint> result;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (problem.boundary_of(faces[f]).condition != Condition::far_field) continue;
    const auto face = element.face(f);
    const auto of_u = face.values(state.u), of_w = face.values(w);
    const auto behind = face.behind(state.u);
    face.at_points([&](const auto& on_face) {
      WallPoint point{on_face.position,
                      on_face.normal,
                      on_face.area,
                      behind.gradient(on_face),
                      interpolated(on_face.value, of_u),
                      interpolated(on_face.value, of_w)};
      if (!problem.input.split) {
        point.u -= problem.profile.potential(point.position.z);
        point.gradient.z -= problem.profile.slope(point.position.z);
      }
      result.push_back(point);
    });
  }
  return result;
}

/// A source of the fitted potential: a point, or the flat wall normal to `axis` at `center`.
struct Source {
  Vec3 center;
  int axis = -1;
  double size = 0;  ///< radius: only keeps the numbers of the fit near 1
};

std::vector<Source> sources_of(const State& state, const std::vector<Electrode>& electrodes) {
  std::vector<Source> result;
  for (const auto& sphere : state.problem.input.spheres) result.push_back({sphere.center, -1, sphere.radius});
  const auto& patches = state.problem.domain.patches;
  for (const auto& electrode : electrodes) {
    if (electrode.sphere != nullptr) continue;
    int axis = -1;
    for (std::size_t p = 0; p < patches.size(); ++p)
      if (electrode.has(static_cast<int>(p))) axis = patches[p].axis;
    if (axis >= 0 || state.problem.input.spheres.empty()) result.push_back({electrode.center, axis, 0});
  }
  return result;
}

/// Values of the functions of the fit at a point, and their slopes along its normal.
struct Basis {
  std::vector<double> value, slope;
};

Basis basis_at(const std::vector<Source>& sources, const WallPoint& point) {
  Basis result;
  for (const auto& source : sources) {
    const auto away = point.position - source.center;
    if (source.axis >= 0) {
      const double d = away[at(source.axis)], f = std::exp(-std::abs(d));
      result.value.push_back(f);
      result.slope.push_back(-std::copysign(f, d) * point.normal[at(source.axis)]);
      continue;
    }
    const double r = norm(away), decay = std::exp(source.size - r), k0 = decay / r, k1 = k0 * (1 + 1 / r);
    const auto direction = (1 / r) * away;
    result.value.push_back(k0);
    result.slope.push_back(-k1 * dot(direction, point.normal));
    // The dipole k1 direction: its radial derivative is -(k0 + 2 k1 / r), the direction turns with 1/r.
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double along = dot(direction, point.normal);
      result.value.push_back(k1 * direction[axis]);
      result.slope.push_back(-(k0 + 2 * k1 / r) * along * direction[axis] +
                             k1 / r * (point.normal[axis] - along * direction[axis]));
    }
  }
  return result;
}

/// Solves the normal equations of least squares, whose columns may depend on one another: each pivot is at least a
/// 1e-10th of its diagonal. `matrix` has n rows of n.
std::vector<double> solve_normal_equations(std::vector<double> matrix, std::vector<double> right) {
  const auto n = right.size();
  for (std::size_t i = 0; i < n; ++i) matrix[i * n + i] *= 1 + 1e-10;
  for (std::size_t k = 0; k < n; ++k) {
    const double pivot = matrix[k * n + k];
    for (std::size_t i = k + 1; i < n; ++i) {
      const double factor = pivot > 0 ? matrix[i * n + k] / pivot : 0;
      for (std::size_t j = k; j < n; ++j) matrix[i * n + j] -= factor * matrix[k * n + j];
      right[i] -= factor * right[k];
    }
  }
  for (std::size_t k = n; k-- > 0;) {
    for (std::size_t j = k + 1; j < n; ++j) right[k] -= matrix[k * n + j] * right[j];
    right[k] = matrix[k * n + k] > 0 ? right[k] / matrix[k * n + k] : 0;
  }
  return right;
}

std::vector<double> fit(const par::Comm& comm, const std::vector<Source>& sources,
                        const std::vector<WallPoint>& points) {
  std::size_t n = 0;
  for (const auto& source : sources) n += source.axis >= 0 ? 1 : 4;
  std::vector<par::ExactSum> sums(n * n + n);
  for (const auto& point : points) {
    const auto basis = basis_at(sources, point);
    for (std::size_t i = 0; i < n; ++i) {
      for (std::size_t j = 0; j <= i; ++j) sums[i * n + j].add(point.area * basis.value[i] * basis.value[j]);
      sums[n * n + i].add(point.area * basis.value[i] * point.u);
    }
  }
  auto totals = par::reproducible_sums(comm, sums);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t j = 0; j < i; ++j) totals[j * n + i] = totals[i * n + j];
  const auto end = totals.begin() + static_cast<std::ptrdiff_t>(n * n);
  return solve_normal_equations({totals.begin(), end}, {end, totals.end()});
}

/// Rate of decay of a quadrupole less that of a monopole at the distance of the nearest point source; 1 without one.
double surplus_rate(const std::vector<Source>& sources, Vec3 position) {
  double r = HUGE_VAL;
  for (const auto& source : sources)
    if (source.axis < 0) r = std::min(r, norm(position - source.center));
  if (!(r < HUGE_VAL)) return 1;
  const double k1 = 1 + 1 / r, k2 = 1 + 3 / r * k1;  // over k0
  return k1 / k2 + 3 / r - k1;
}

/// Stress along `axis` on a part of a wall, without what the profile of the plate makes alone, and as the mid-plane form
/// has it: terms that are linear in u add up to nothing over a plane at right angles to the axis.
double stress_on(const Problem& problem, const WallPoint& point, std::size_t axis) {
  const double z = point.position.z;
  const auto& g = point.gradient;
  const double through = dot(g, point.normal) + point.normal.z * problem.profile.slope(z);
  const double pressure = 0.5 * squared_norm(g) + problem.term.convex_rest(point.u, problem.profile.potential(z));
  return point.area * (through * g[axis] - pressure * point.normal[axis]);
}

}  // namespace

double far_field_cost(const par::Comm& comm, const State& state, const std::vector<Electrode>& electrodes,
                      const Goal& goal, std::span<const double> w) {
  const auto& domain = state.problem.domain;
  const auto& input = state.problem.input;
  if (std::none_of(input.boundary.begin(), input.boundary.end(),
                   [](const Boundary& b) { return b.condition == Condition::far_field; }))
    return 0;
  const auto points = with_element(domain, [&](const auto& element) { return far_field_points(element, state, w); });
  const auto sources = sources_of(state, electrodes);
  const auto amount = fit(comm, sources, points);
  const bool is_midplane = goal.kind == Goal::Kind::midplane;
  const auto axis = is_midplane ? at(domain.patches[at(domain.patch_number(input.force.midplane))].axis) : 0;
  std::array<par::ExactSum, 2> sums;
  for (const auto& point : points) {
    const auto basis = basis_at(sources, point);
    double value = 0, slope = 0;
    for (std::size_t k = 0; k < amount.size(); ++k) {
      value += amount[k] * basis.value[k];
      slope += amount[k] * basis.slope[k];
    }
    const double alpha = far_field_coefficient(input.spheres, point.position, point.normal);
    const double curvature = std::abs(state.problem.term.flat_wall_slope(point.u) - std::abs(point.u));
    const double lacks =
        std::abs(slope + alpha * value) + surplus_rate(sources, point.position) * std::abs(point.u - value) + curvature;
    sums[0].add(point.area * std::abs(point.w) * lacks);
    if (is_midplane) sums[1].add(stress_on(state.problem, point, axis));
  }
  const auto totals = par::reproducible_sums(comm, sums);
  return 2 * (totals[0] + std::abs(totals[1]));
}

}  // namespace pamr::poisson_boltzmann
