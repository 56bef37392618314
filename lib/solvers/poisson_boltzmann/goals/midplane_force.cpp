// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/midplane_force.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/fem/quadrature.hpp"
#include "solvers/poisson_boltzmann/goals/quadratic_analysis.hpp"
#include "solvers/poisson_boltzmann/goals/quadratic_goals.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

Excess excess_of(const State& state) {
  const auto& problem = state.problem;
  Excess result{{state.u.begin(), state.u.end()}, problem.conditions.psi0};
  if (problem.input.split || !problem.input.plate) return result;
  for (std::size_t i = 0; i < result.u.size(); ++i) {
    result.psi0[i] = problem.profile.potential(problem.domain.point[i].z);
    result.u[i] -= result.psi0[i];
  }
  return result;
}

namespace {

/// The triangle of a mirror: gradients of its three corner functions within it.
std::array<Vec3, 3> triangle_gradients(const Domain& domain, const BoundaryFace& face) {
  std::array<Vec3, 3> p, result;
  for (std::size_t k = 0; k < 3; ++k) p[k] = domain.point[at(face.node[k])];
  for (std::size_t k = 0; k < 3; ++k)
    result[k] = (0.5 / face.area) * cross(face.normal, p[(k + 2) % 3] - p[(k + 1) % 3]);
  return result;
}

/// The excess on a triangle of a mirror.
class MirrorTriangle {
 public:
  MirrorTriangle(const Problem& problem, const BoundaryFace& face, const Excess& excess)
      : problem_(problem), face_(face), excess_(excess), gradients(triangle_gradients(problem.domain, face)) {
    for (std::size_t k = 0; k < 3; ++k) gradient += excess.u[at(face.node[k])] * gradients[k];
  }

  /// Calls `use(point, u, psi0)` for each point of the quadrature rule. psi0 is the profile at the point: between its
  /// values at the nodes a straight line is far above it near a plate of high potential.
  template <class Use>
  void at_points(const Use& use) const {
    for (const auto& point : triangle_points) {
      double u = 0, z = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        u += point.weight_of_corner[k] * excess_.u[at(face_.node[k])];
        z += point.weight_of_corner[k] * problem_.domain.point[at(face_.node[k])].z;
      }
      use(point, u, problem_.profile.potential(z));
    }
  }

 private:
  const Problem& problem_;
  const BoundaryFace& face_;
  const Excess& excess_;

 public:
  std::array<Vec3, 3> gradients;  ///< of the corner functions, within the triangle
  Vec3 gradient;                  ///< of u, within the triangle
};

}  // namespace

double midplane_force(const par::Comm& comm, const State& state, const Excess& excess, int patch) {
  const auto& problem = state.problem;
  if (problem.domain.quadratic) return quadratic_midplane_force(comm, state, patch);
  std::array<par::ExactSum, 1> sum;
  for (const auto& face : problem.domain.faces) {
    if (face.patch != patch) continue;
    const MirrorTriangle triangle(problem, face, excess);
    double rest = 0;
    triangle.at_points([&](const TrianglePoint& point, double u, double psi0) {
      rest += point.weight * problem.term.convex_rest(u, psi0);
    });
    sum[0].add(face.area * (0.5 * squared_norm(triangle.gradient) + rest));
  }
  return par::reproducible_sums(comm, sum)[0];
}

std::vector<double> midplane_derivative(const par::Comm& comm, const State& state, const Excess& excess, int patch) {
  const auto& problem = state.problem;
  if (problem.domain.quadratic) return quadratic_midplane_derivative(comm, state, patch);
  std::vector<double> result(problem.domain.point.size(), 0);
  for (const auto& face : problem.domain.faces) {
    if (face.patch != patch) continue;
    const MirrorTriangle triangle(problem, face, excess);
    for (std::size_t k = 0; k < 3; ++k)
      result[at(face.node[k])] += face.area * dot(triangle.gradient, triangle.gradients[k]);
    triangle.at_points([&](const TrianglePoint& point, double u, double psi0) {
      const double value = face.area * point.weight * problem.term.value(u, psi0);
      for (std::size_t k = 0; k < 3; ++k) result[at(face.node[k])] += value * point.weight_of_corner[k];
    });
  }
  problem.domain.nodes.sum_copies(comm, result);
  return result;
}

double midplane_remainder(const par::Comm& comm, const State& state, int patch) {
  const auto& domain = state.problem.domain;
  std::array<par::ExactSum, 1> sum;
  for (const auto& face : domain.faces) {
    if (face.patch != patch) continue;
    const auto gradients = triangle_gradients(domain, face);
    Vec3 gradient, total;
    double squares = 0;
    for (std::size_t k = 0; k < 3; ++k) gradient += state.u[at(face.node[k])] * gradients[k];
    for (const auto node : face.node) {
      const auto& recovered = state.recovered[at(node)];
      const auto error = recovered - dot(recovered, face.normal) * face.normal - gradient;
      total += error;
      squares += squared_norm(error);
    }
    sum[0].add(0.5 * face.area / 12 * (squares + squared_norm(total)));
  }
  return par::reproducible_sums(comm, sum)[0];
}

namespace {

/// Osmotic pressure at a node, and less that of the profile.
struct NodalPressure {
  double total = 0, rest = 0;
};

std::vector<NodalPressure> pressure_at_nodes(const Problem& problem, const Excess& excess) {
  std::vector<NodalPressure> result(excess.u.size());
  for (std::size_t i = 0; i < result.size(); ++i) {
    result[i].total = problem.term.pressure(excess.psi0[i] + excess.u[i], 0);
    if (problem.input.plate) result[i].rest = problem.term.pressure(excess.u[i], excess.psi0[i]);
  }
  return result;
}

}  // namespace

Energy energy_of(const par::Comm& comm, const State& state, const Excess& excess) {
  const auto& problem = state.problem;
  if (problem.domain.quadratic) return quadratic_energy(comm, state);
  const auto& domain = problem.domain;
  const auto& cells = domain.mesh->cell_to_node;
  const bool has_plate = problem.input.plate.has_value();
  const auto pressure = pressure_at_nodes(problem, excess);
  std::array<par::ExactSum, 2> sums;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto p = domain.points(c);
    NodalPressure mean;
    for (const auto node : cells[c]) {
      mean.total += pressure[at(node)].total / 4;
      mean.rest += pressure[at(node)].rest / 4;
    }
    if (!has_plate) {
      sums[0].add(geometry::volume(p) * (0.5 * squared_norm(state.cell_gradient[c]) + mean.total));
      continue;
    }
    // One of the two gradients is that of the unknown, the other adds or takes away that of the profile.
    const auto shape = shape_of(p);
    Vec3 of_profile, base;
    auto low = at(cells[c][0]), high = low;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto i = at(cells[c][k]);
      of_profile += excess.psi0[i] * shape.gradient[k];
      if (domain.point[i].z < domain.point[low].z) low = i;
      if (domain.point[i].z > domain.point[high].z) high = i;
    }
    const bool is_split = problem.input.split;
    const auto rest = is_split ? state.cell_gradient[c] : state.cell_gradient[c] - of_profile;
    const auto total = is_split ? state.cell_gradient[c] + of_profile : state.cell_gradient[c];
    sums[0].add(shape.volume * (0.5 * squared_norm(total) + mean.total));
    base.z =
        problem.profile.mean_slope({domain.point[low].z, excess.psi0[low]}, {domain.point[high].z, excess.psi0[high]});
    sums[1].add(shape.volume * (0.5 * squared_norm(rest) + dot(rest, base) + mean.rest));
  }
  const auto totals = par::reproducible_sums(comm, sums);
  return {totals[0], has_plate ? totals[1] : totals[0]};
}

}  // namespace pamr::poisson_boltzmann
