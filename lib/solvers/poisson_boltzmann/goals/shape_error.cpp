// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/shape_error.hpp"

#include <array>

#include "pamr/base/index.hpp"
#include "pamr/geometry/surface.hpp"
#include "solvers/poisson_boltzmann/fem/quadrature.hpp"
#include "solvers/poisson_boltzmann/goals/wall_stress.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

/// Mean distance of the surface from a face, positive where the surface lies on the side of the liquid. Debye lengths.
double mean_distance(const Domain& domain, const BoundaryFace& face, const geometry::Surface& surface) {
  double result = 0;
  for (const auto& point : triangle_points) {
    Vec3 on_face;
    for (std::size_t k = 0; k < 3; ++k)
      on_face += point.weight_of_corner[k] * domain.mesh->node_position[at(face.node[k])];
    result -= point.weight * domain.scale * dot(surface.project(on_face) - on_face, face.normal);
  }
  return result;
}

}  // namespace

double shape_error(const par::Comm& comm, const State& state, const GoalFunctional& functional,
                   std::span<const Vec3> gradient) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  const auto& patches = domain.mesh->info.patches;
  std::array<par::ExactSum, 1> sum;
  for (const auto& face : domain.faces) {
    const auto* b = problem.input.find_boundary(patches[at(face.patch)].name);
    const auto* surface = domain.mesh->info.surface_of(face.patch);
    if (b->condition != Condition::potential || surface == nullptr || surface->is_flat()) continue;
    const double distance = mean_distance(domain, face, *surface);
    // dpsi/dn, n out of the body into the liquid, and what else the functional has there; means of the corners.
    double slope = 0, source = 0, pressure = 0, weight = 0;
    for (const auto node : face.node) {
      const auto i = at(node);
      slope -= reaction_charge(problem, state.reaction, face.normal, i).value_or(0) / 3;
      source += problem.term.pressure_slope(state.u[i], problem.conditions.psi0[i]) / 3;
      pressure += problem.term.pressure(state.u[i], problem.conditions.psi0[i]) / 3;
      weight += functional.fixed.empty() ? 0 : functional.fixed[i] / 3;
    }
    const double dual_slope = -dot(gradient[at(face.cell)], face.normal);
    double change = 0;
    if (functional.goal.kind == Goal::Kind::charge) {
      change = slope * dual_slope - weight * source;
    } else if (functional.goal.kind == Goal::Kind::energy) {
      const double base = problem.split_slope(face.node);
      change = 0.5 * (slope * slope + base * base) - pressure;
    } else {
      change = -slope * dual_slope;
    }
    sum[0].add(face.area * distance * change);
  }
  return par::reproducible_sums(comm, sum)[0];
}

}  // namespace pamr::poisson_boltzmann
