// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/dual_gradient.hpp"

#include <array>

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/fem/elements.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

/// Slopes at the corners of a cell of the straight line that the profile's slope is at the Gauss points, which the load
/// of the dual system knows it by: in a layer that no cell resolves the slope at a node of the plate is far above.
std::array<double, 4> split_slopes(const Problem& problem, std::size_t cell) {
  std::array<double, 4> result{};
  if (!problem.input.split) return result;
  double sum = 0;
  LinearElement::Points(problem.domain, cell).at_points([&](const auto& point) {
    result[point.index] = problem.split_slope(point.position.z);
    sum += result[point.index];
  });
  constexpr double near = gauss_points[0].weight_of_corner[0], far = gauss_points[0].weight_of_corner[1];
  for (auto& slope : result) slope = (slope - far * sum) / (near - far);
  return result;
}

}  // namespace

DualGradient dual_gradient(const par::Comm& comm, const State& state, const GoalFunctional& functional,
                           std::span<const double> w) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  const auto recovery = problem.input.estimator.recovery;
  DualGradient result;
  result.of_cells = cell_gradients(domain, w);
  if (functional.cut_off.empty()) {
    result.recovered = recover(comm, domain, result.of_cells, recovery);
    return result;
  }
  result.cut_off = cell_gradients(domain, functional.cut_off);
  result.along.resize(result.cut_off.size());
  auto smooth = result.of_cells;
  for (std::size_t c = 0; c < smooth.size(); ++c) {
    if (result.cut_off[c] == Vec3{}) continue;
    const auto p = domain.points(c);
    const auto base = split_slopes(problem, c);
    const double mean = 0.25 * (base[0] + base[1] + base[2] + base[3]);
    const auto along = [&](Vec3 gradient, double of_base, Vec3 point) {
      return dot(functional.component.at(point), gradient + Vec3{0, 0, of_base});
    };
    smooth[c] += along(state.cell_gradient[c], mean, 0.25 * (p[0] + p[1] + p[2] + p[3])) * result.cut_off[c];
    const auto& nodes = domain.recovery_nodes(c);
    for (std::size_t k = 0; k < 4; ++k) result.along[c][k] = along(state.recovered[at(nodes[k])], base[k], p[k]);
  }
  result.recovered = recover(comm, domain, smooth, recovery);
  return result;
}

}  // namespace pamr::poisson_boltzmann
