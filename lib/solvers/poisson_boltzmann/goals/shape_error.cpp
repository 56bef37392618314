// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/shape_error.hpp"

#include <array>
#include <cmath>

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/fem/quadrature.hpp"
#include "solvers/poisson_boltzmann/goals/shape_change.hpp"
#include "solvers/poisson_boltzmann/goals/wall_stress.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

Vec3 mean_of(std::span<const Vec3> at_nodes, const BoundaryFace& face) {
  Vec3 sum;
  for (const auto node : face.node) sum += (1.0 / 3) * at_nodes[at(node)];
  return sum;
}

/// The gradients at a face, by nodal reactions where these are known; values stay 0.
WallTraces traces_at(const State& state, const BoundaryFace& face, const Boundary& b, Vec3 dual_gradient) {
  const auto& problem = state.problem;
  WallTraces traces;
  traces.normal = face.normal;
  traces.dual_gradient = dual_gradient;
  traces.base = problem.split_slope(face.node);
  if (b.condition != Condition::potential) {
    traces.gradient = state.cell_gradient[at(face.cell)] + Vec3{0, 0, traces.base};
    return traces;
  }
  for (const auto node : face.node)
    traces.gradient += reaction_charge(problem, state.reaction, face.normal, at(node)).value_or(0) / 3 * face.normal;
  return traces;
}

}  // namespace

ShapeError shape_error(const par::Comm& comm, const State& state, const GoalFunctional& functional,
                       const DualGradients& dual) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  std::array<par::ExactSum, 3> sums;
  for (const auto& face : domain.faces) {
    const auto& b = *problem.input.find_boundary(domain.mesh->info.patches[at(face.patch)].name);
    const auto* surface = domain.mesh->info.surface_of(face.patch);
    if (!is_curved_wall(b, surface)) continue;
    auto traces = traces_at(state, face, b, dual.of_cells[at(face.cell)]);
    traces.counted = functional.counts(face.patch) ? 1 : 0;
    const auto gradient = mean_of(state.recovered, face) + Vec3{0, 0, traces.base};
    const auto dual_gradient = mean_of(dual.recovered, face);
    double squares = 0;
    GapWave wave;
    for (const auto& point : triangle_points) {
      WallPlace place{{}, face.normal, point.weight * face.area};
      traces.u = traces.psi0 = traces.w = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        const auto i = at(face.node[k]);
        const double weight = point.weight_of_corner[k];
        place.point += weight * domain.point[i];
        traces.u += weight * state.u[i];
        traces.psi0 += weight * problem.conditions.psi0[i];
        traces.w += weight * dual.w[i];
      }
      const auto shift = wall_shift(domain, b, *surface, place, std::sqrt(face.area));
      const double change = place.area * shape_change(problem, functional.goal, b, traces, shift);
      auto other = traces;
      other.gradient = gradient;
      other.dual_gradient = dual_gradient;
      sums[0].add(change);
      sums[1].add(place.area * shape_change(problem, functional.goal, b, other, shift) - change);
      squares += shift.distance * change;
      wave.add(domain, *surface, place, shift.distance);
    }
    sums[2].add(wave.number() * squares);
  }
  const auto totals = par::reproducible_sums(comm, sums);
  return {totals[0], std::abs(totals[1]) + std::abs(totals[2])};
}

}  // namespace pamr::poisson_boltzmann
