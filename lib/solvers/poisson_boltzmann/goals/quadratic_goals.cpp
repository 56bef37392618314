// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/quadratic_goals.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/goals/cubic_correction.hpp"
#include "solvers/poisson_boltzmann/goals/cubic_sites.hpp"
#include "solvers/poisson_boltzmann/goals/quadratic_analysis.hpp"
#include "solvers/poisson_boltzmann/goals/shape_change.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

/// The functions of the cell behind a face at a point of the face.
CubicAt cubic_behind(const Domain& domain, std::size_t face, const FacePoint& point) {
  const auto& elements = *domain.quadratic;
  const auto l = elements.barycentric_behind(domain, face, point);
  return cubic_at(elements.points(domain, at(domain.faces[face].cell)), cell_point(l), cubic_point(l));
}

Vec3 gradient_of(const CubicAt& here, const OfCubicCell<double>& value) {
  Vec3 sum;
  for (std::size_t k = 0; k < n_cubic; ++k) sum += value[k] * here.gradient[k];
  return sum;
}

bool varies(const OfCellNodes<double>& value) {
  return std::any_of(value.begin(), value.end(), [&](double v) { return v != value[0]; });
}

/// Derivatives by the coefficients of all functions, collected cell by cell.
class Derivative {
 public:
  explicit Derivative(const CubicFunctions& functions) : functions_(functions), value_(functions.all.n_nodes(), 0) {}

  void add(std::size_t cell, const OfCubicCell<double>& of_cell) {
    for (std::size_t k = 0; k < n_cubic; ++k)
      value_[at(functions_.cell_to_function[cell][k])] += functions_.sign(cell, k) * of_cell[k];
  }
  std::vector<double> total(const par::Comm& comm) {
    functions_.all.sum_copies(comm, value_);
    return std::move(value_);
  }

 private:
  const CubicFunctions& functions_;
  std::vector<double> value_;
};

/// Adds the derivative of `weight` times the component of the stress on a plane of normal n: `gradient` is that of psi,
/// `pressure_slope` that of the pressure.
void add_stress_derivative(const CubicAt& here, double weight, Vec3 gradient, double pressure_slope, Vec3 n,
                           Vec3 direction, OfCubicCell<double>& to) {
  const double through = dot(gradient, n), along = dot(n, direction), forward = dot(gradient, direction);
  for (std::size_t k = 0; k < n_cubic; ++k)
    to[k] += weight * (dot(here.gradient[k], direction) * through + forward * dot(here.gradient[k], n) -
                       along * (dot(gradient, here.gradient[k]) + pressure_slope * here.value[k]));
}

}  // namespace

std::vector<double> quadratic_volume_form_derivative(const par::Comm& comm, const State& state,
                                                     std::span<const double> chi, std::uint64_t open_walls,
                                                     const Component& component) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  const auto& elements = *domain.quadratic;
  Derivative result(state.cubic->functions());
  for (std::size_t c = 0; c < elements.cell_to_node.size(); ++c) {
    const auto cut = elements.values(c, chi), value = elements.values(c, state.u);
    if (!varies(cut)) continue;
    const auto node = elements.points(domain, c);
    OfCubicCell<double> of_cell{};
    for (std::size_t p = 0; p < cell_points().size(); ++p) {
      const auto& point = cell_points()[p];
      const auto here = cubic_at(node, point, cubic_points()[p]);
      const double z = here.placed.position.z;
      const auto gradient = gradient_of(here.placed, value) + Vec3{0, 0, problem.split_slope(z)};
      const double slope = problem.term.pressure_slope(interpolated(point.value, value), problem.split_potential(z));
      add_stress_derivative(here, -point.weight * here.placed.jacobian / 6, gradient, slope,
                            gradient_of(here.placed, cut), component.at(here.placed.position), of_cell);
    }
    result.add(c, of_cell);
  }
  for (std::size_t f = 0; f < domain.faces.size(); ++f) {
    if ((open_walls >> static_cast<unsigned>(domain.faces[f].patch) & 1U) == 0) continue;
    const auto c = at(domain.faces[f].cell);
    const auto position = elements.face_points(domain, f);
    const auto cut = elements.values(c, chi), value = elements.values(c, state.u);
    OfCubicCell<double> of_cell{};
    for (const auto& point : face_points()) {
      const auto placed = place(position, point);
      const auto here = cubic_behind(domain, f, point);
      double share = 0, u = 0;
      for (std::size_t k = 0; k < 10; ++k) {
        share += here.value[k] * cut[k];
        u += here.value[k] * value[k];
      }
      const double z = placed.position.z;
      const auto gradient = gradient_of(here.placed, value) + Vec3{0, 0, problem.split_slope(z)};
      add_stress_derivative(here, share * placed.area, gradient,
                            problem.term.pressure_slope(u, problem.split_potential(z)), placed.normal,
                            component.at(placed.position), of_cell);
    }
    result.add(c, of_cell);
  }
  return result.total(comm);
}

std::vector<double> quadratic_volume_form_remainder(const State& state, std::span<const double> chi,
                                                    std::uint64_t open_walls, const Component& component) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  const auto& elements = *domain.quadratic;
  const auto& functions = state.cubic->functions();
  std::vector<double> result(elements.cell_to_node.size(), 0);
  for (std::size_t c = 0; c < result.size(); ++c) {
    const auto cut = elements.values(c, chi);
    if (!varies(cut)) continue;
    const auto node = elements.points(domain, c);
    const auto value = elements.values(c, state.u);
    const auto error = functions.values(c, state.cubic->error());
    for (std::size_t p = 0; p < cell_points().size(); ++p) {
      const auto& point = cell_points()[p];
      const auto here = cubic_at(node, point, cubic_points()[p]);
      const auto slope = gradient_of(here.placed, cut), direction = component.at(here.placed.position);
      const auto g = gradient_of(here, error);
      const double e = interpolated(here.value, error);
      const double psi0 = problem.split_potential(here.placed.position.z);
      const double squares = squared_norm(g) + problem.term.slope(interpolated(point.value, value), psi0) * e * e;
      result[c] -= point.weight * here.placed.jacobian / 6 *
                   (dot(g, direction) * dot(g, slope) - 0.5 * squares * dot(slope, direction));
    }
  }
  for (std::size_t f = 0; f < domain.faces.size(); ++f) {
    if ((open_walls >> static_cast<unsigned>(domain.faces[f].patch) & 1U) == 0) continue;
    const auto c = at(domain.faces[f].cell);
    const auto position = elements.face_points(domain, f);
    const auto cut = elements.values(c, chi), value = elements.values(c, state.u);
    const auto error = functions.values(c, state.cubic->error());
    for (const auto& point : face_points()) {
      const auto placed = place(position, point);
      const auto here = cubic_behind(domain, f, point);
      const auto direction = component.at(placed.position), g = gradient_of(here, error);
      double share = 0, u = 0;
      for (std::size_t k = 0; k < 10; ++k) {
        share += here.value[k] * cut[k];
        u += here.value[k] * value[k];
      }
      const double e = interpolated(here.value, error), psi0 = problem.split_potential(placed.position.z);
      const double squares = squared_norm(g) + problem.term.slope(u, psi0) * e * e;
      result[c] += share * placed.area *
                   (dot(g, direction) * dot(g, placed.normal) - 0.5 * squares * dot(placed.normal, direction));
    }
  }
  return result;
}

std::vector<double> quadratic_midplane_derivative(const par::Comm& comm, const State& state, int patch) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  const auto& elements = *domain.quadratic;
  Derivative result(state.cubic->functions());
  for (std::size_t f = 0; f < domain.faces.size(); ++f) {
    if (domain.faces[f].patch != patch) continue;
    const auto c = at(domain.faces[f].cell);
    const auto position = elements.face_points(domain, f);
    const auto value = elements.values(c, state.u);
    OfCubicCell<double> of_cell{};
    for (const auto& point : face_points()) {
      const auto placed = place(position, point);
      const auto here = cubic_behind(domain, f, point);
      const double z = placed.position.z, psi0 = problem.profile.potential(z);
      auto gradient = gradient_of(here.placed, value);
      double u = 0;
      for (std::size_t k = 0; k < 10; ++k) u += here.value[k] * value[k];
      if (!problem.input.split) {
        u -= psi0;
        gradient -= Vec3{0, 0, problem.profile.slope(z)};
      }
      gradient -= dot(gradient, placed.normal) * placed.normal;
      const double source = problem.term.value(u, psi0);
      for (std::size_t k = 0; k < n_cubic; ++k)
        of_cell[k] += placed.area * (dot(gradient, here.gradient[k]) + source * here.value[k]);
    }
    result.add(c, of_cell);
  }
  return result.total(comm);
}

std::vector<double> quadratic_midplane_remainder(const State& state, int patch) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  const auto& elements = *domain.quadratic;
  std::vector<double> result(elements.cell_to_node.size(), 0);
  for (std::size_t f = 0; f < domain.faces.size(); ++f) {
    if (domain.faces[f].patch != patch) continue;
    const auto c = at(domain.faces[f].cell);
    const auto position = elements.face_points(domain, f);
    const auto value = elements.values(c, state.u);
    const auto error = state.cubic->functions().values(c, state.cubic->error());
    for (const auto& point : face_points()) {
      const auto placed = place(position, point);
      const auto here = cubic_behind(domain, f, point);
      auto g = gradient_of(here, error);
      g -= dot(g, placed.normal) * placed.normal;
      double u = 0;
      for (std::size_t k = 0; k < 10; ++k) u += here.value[k] * value[k];
      const double e = interpolated(here.value, error), psi0 = problem.split_potential(placed.position.z);
      result[c] += 0.5 * placed.area * (squared_norm(g) + problem.term.slope(u, psi0) * e * e);
    }
  }
  return result;
}

std::vector<double> quadratic_energy_derivative(const par::Comm& comm, const State& state) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  const auto& functions = state.cubic->functions();
  std::vector<double> result(functions.all.n_nodes(), 0);
  for (std::size_t f = 0; f < domain.faces.size(); ++f) {
    const auto& b = *problem.input.find_boundary(domain.mesh->info.patches[at(domain.faces[f].patch)].name);
    if (!b.holds_charge() && b.condition != Condition::far_field) continue;
    const auto position = domain.quadratic->face_points(domain, f);
    const auto& function = functions.face_to_function[f];
    for (const auto& point : face_points()) {
      const auto placed = place(position, point);
      const auto shape = cubic_face_values(point);
      double u = 0;
      for (std::size_t k = 0; k < 6; ++k) u += shape[k] * state.u[at(function[k])];
      const double flux = placed.area * outward_slope(problem, b, placed, u);
      for (std::size_t k = 0; k < 10; ++k) result[at(function[k])] += functions.face_sign(f, k) * flux * shape[k];
    }
  }
  functions.all.sum_copies(comm, result);
  return result;
}

std::vector<double> quadratic_charge_derivative(const par::Comm& comm, const State& state, const GoalFunctional& goal) {
  const auto& functions = state.cubic->functions();
  std::vector<double> result(functions.all.n_nodes(), 0);
  at_cubic_sites(state.problem, state.u, functions, [&](const SitePoint& point, const OfCubicFace<double>& shape) {
    if (!goal.counts(state.problem.domain.faces[point.face].patch)) return;
    const auto& function = functions.face_to_function[point.face];
    const double amount = -point.area * point.site->slope(point.psi);
    for (std::size_t k = 0; k < shape.size(); ++k) result[at(function[k])] += amount * shape[k];
  });
  functions.all.sum_copies(comm, result);
  return result;
}

std::vector<double> quadratic_charge_remainder(const State& state, const GoalFunctional& goal) {
  const auto& domain = state.problem.domain;
  std::vector<double> result(domain.quadratic->cell_to_node.size(), 0);
  const auto& functions = state.cubic->functions();
  at_cubic_sites(state.problem, state.u, functions, [&](const SitePoint& point, const OfCubicFace<double>& shape) {
    if (!goal.counts(domain.faces[point.face].patch)) return;
    const double error = on_face(functions.face_to_function[point.face], shape, state.cubic->error());
    result[at(domain.faces[point.face].cell)] += 0.5 * point.area * point.site->curvature(point.psi) * error * error;
  });
  return result;
}

double quadratic_shape_error(const par::Comm& comm, const State& state, const GoalFunctional& functional,
                             CubicGoalError& dual) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  const auto& elements = *domain.quadratic;
  const auto& functions = state.cubic->functions();
  std::array<par::ExactSum, 1> sum;
  for (std::size_t f = 0; f < domain.faces.size(); ++f) {
    const auto& face = domain.faces[f];
    const auto& b = *problem.input.find_boundary(domain.mesh->info.patches[at(face.patch)].name);
    const auto* surface = domain.mesh->info.surface_of(face.patch);
    if (!is_curved_wall(b, surface)) continue;
    const auto c = at(face.cell);
    const auto position = elements.face_points(domain, f);
    const auto of_second = elements.values(c, state.u);
    const auto error = functions.values(c, state.cubic->error()), all = functions.values(c, dual.dual);
    auto value = error, added = all;  // what third order adds to the dual solution
    for (std::size_t k = 0; k < 10; ++k) {
      value[k] += of_second[k];
      added[k] = 0;
    }
    const double rest_u = state.cubic->decay()[c], rest_w = dual.decay[c];
    const double size = std::sqrt(face.area);
    double of_face = 0, spread = 0, squares = 0;
    GapWave wave;
    for (const auto& point : face_points()) {
      const auto placed = place(position, point);
      const auto behind = cubic_behind(domain, f, point);
      const auto shift = wall_shift(domain, b, *surface, {placed.position, placed.normal}, size);
      const double z = placed.position.z, psi0 = problem.split_potential(z), base = problem.split_slope(z);
      const double u = b.condition == Condition::potential ? b.value - psi0 : interpolated(behind.value, value);
      const WallTraces traces{placed.normal,
                              gradient_of(behind, value) + Vec3{0, 0, base},
                              u,
                              psi0,
                              base,
                              gradient_of(behind, all),
                              interpolated(behind.value, all),
                              functional.counts(face.patch) ? 1.0 : 0.0};
      auto further_u = traces, further_w = traces;
      further_u.gradient += rest_u * gradient_of(behind, error);
      if (b.condition != Condition::potential) further_u.u += rest_u * interpolated(behind.value, error);
      further_w.dual_gradient += rest_w * gradient_of(behind, added);
      further_w.w += rest_w * interpolated(behind.value, added);
      const auto change = [&](const WallTraces& at_point) {
        return placed.area * shape_change(problem, functional.goal, b, at_point, shift);
      };
      const double here = change(traces);
      of_face += here;
      spread += std::abs(change(further_u) - here) + std::abs(change(further_w) - here);
      squares += shift.distance * here;
      wave.add(domain, *surface, {placed.position, placed.normal, placed.area}, shift.distance);
    }
    sum[0].add(of_face);
    dual.rest.add(c, wave.number() * squares, spread);
  }
  dual.rest.unsolved += charge_at_edges(comm, state, functional.counted, dual.dual);
  return par::reproducible_sums(comm, sum)[0];
}

}  // namespace pamr::poisson_boltzmann
