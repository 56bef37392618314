// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/midplane_force.hpp"

#include <array>
#include <type_traits>

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/goals/goal_space.hpp"

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

/// The excess at a point of a mirror. psi0 is the profile there: between its values at the nodes a straight line is far
/// above it near a plate of high potential.
struct MirrorPoint {
  double u = 0, psi0 = 0;
  Vec3 gradient;  ///< of u, within the mirror
};

/// Calls `use(face, point, excess)` for the points of a mirror. Of first order u is straight between its values at the
/// nodes, of second the profile is taken away at each point.
template <class Element, class Use>
void at_mirror_points(const Element& element, const State& state, const Excess& excess, int patch, const Use& use) {
  const auto& problem = state.problem;
  constexpr bool is_nodal = std::is_same_v<Element, LinearElement>;
  const bool has_profile = !is_nodal && !problem.input.split;
  const auto nodal = is_nodal ? std::span<const double>(excess.u) : state.u;
  for (std::size_t f = 0; f < element.domain.faces.size(); ++f) {
    if (element.domain.faces[f].patch != patch) continue;
    const auto face = element.face(f);
    const auto value = face.values(nodal);
    const auto behind = face.behind(nodal);
    face.at_points([&](const auto& point) {
      const double z = point.position.z, psi0 = problem.profile.potential(z);
      MirrorPoint here{interpolated(point.value, value), psi0, behind.gradient(point)};
      if (has_profile) {
        here.u -= psi0;
        here.gradient -= Vec3{0, 0, problem.profile.slope(z)};
      }
      here.gradient -= dot(here.gradient, point.normal) * point.normal;
      use(face, point, here);
    });
  }
}

}  // namespace

double midplane_force(const par::Comm& comm, const State& state, const Excess& excess, int patch) {
  const auto& problem = state.problem;
  std::array<par::ExactSum, 1> sum;
  with_element(problem.domain, [&](const auto& element) {
    at_mirror_points(element, state, excess, patch, [&](const auto&, const auto& point, const MirrorPoint& here) {
      sum[0].add(point.area * (0.5 * squared_norm(here.gradient) + problem.term.convex_rest(here.u, here.psi0)));
    });
  });
  return par::reproducible_sums(comm, sum)[0];
}

std::vector<double> midplane_derivative(const par::Comm& comm, const State& state, const Excess& excess, int patch) {
  const auto& problem = state.problem;
  return with_element(problem.domain, [&](const auto& element) {
    auto space = goal_space(element, state);
    at_mirror_points(element, state, excess, patch, [&](const auto& face, const auto& point, const MirrorPoint& here) {
      const auto functions = space.behind(face, point);
      const double source = problem.term.value(here.u, here.psi0);
      auto of_cell = functions.value;
      for (std::size_t k = 0; k < of_cell.size(); ++k)
        of_cell[k] = point.area * (dot(here.gradient, functions.gradient[k]) + source * functions.value[k]);
      space.add(at(problem.domain.faces[face.number].cell), of_cell);
    });
    return space.total(comm);
  });
}

std::vector<double> midplane_remainder(const State& state, const Excess& excess, int patch) {
  const auto& problem = state.problem;
  std::vector<double> result(problem.domain.mesh->cell_to_node.size(), 0);
  with_element(problem.domain, [&](const auto& element) {
    const auto space = goal_space(element, state);
    at_mirror_points(element, state, excess, patch, [&](const auto& face, const auto& point, const MirrorPoint& here) {
      const auto c = at(problem.domain.faces[face.number].cell);
      auto error = space.error(c, space.behind(face, point));
      error.gradient -= dot(error.gradient, point.normal) * point.normal;
      result[c] += 0.5 * point.area * squares_of(space, error, [&] { return problem.term.slope(here.u, here.psi0); });
    });
  });
  return result;
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

/// By nodal values of the pressure, of which a node has one for all its cells, and of the profile.
Energy energy_on(const LinearElement& element, const par::Comm& comm, const State& state, const Excess& excess) {
  const auto& problem = state.problem;
  const auto& domain = element.domain;
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

/// By points of the cells.
Energy energy_on(const QuadraticElement& element, const par::Comm& comm, const State& state, const Excess&) {
  const auto& problem = state.problem;
  std::array<par::ExactSum, 2> sums;
  for (std::size_t c = 0; c < element.cells().size(); ++c) {
    const auto cell = element.cell(c);
    const auto u = cell.field(state.u);
    std::array<double, 2> of_cell{};
    cell.at_points([&](const auto& point) {
      const double z = point.position.z, psi0 = problem.profile.potential(z);
      const Vec3 base{0, 0, problem.profile.slope(z)};
      auto rest = u.gradient(point);
      double excess = u.at(point);
      if (!problem.input.split) {
        rest -= base;
        excess -= psi0;
      }
      of_cell[0] += point.weight * (0.5 * squared_norm(rest + base) + problem.term.pressure(excess + psi0, 0));
      of_cell[1] += point.weight * (0.5 * squared_norm(rest) + dot(rest, base) + problem.term.pressure(excess, psi0));
    });
    sums[0].add(of_cell[0]);
    sums[1].add(of_cell[1]);
  }
  const auto totals = par::reproducible_sums(comm, sums);
  return {totals[0], totals[1]};
}

}  // namespace

Energy energy_of(const par::Comm& comm, const State& state, const Excess& excess) {
  return with_element(state.problem.domain,
                      [&](const auto& element) { return energy_on(element, comm, state, excess); });
}

}  // namespace pamr::poisson_boltzmann
