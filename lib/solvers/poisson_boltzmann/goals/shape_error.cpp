// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/shape_error.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/goals/goal_space.hpp"
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

/// The change of a functional by the gap between one face and its surface.
struct FaceShape {
  double change = 0;
  double squares = 0;            ///< size of what is quadratic in the gap
  double drift = 0, spread = 0;  ///< what other traces would change, with and without signs
};

/// Calls `use(cell, FaceShape)` for each face of a curved wall. `traces_of(face, boundary)` returns a function of a
/// point that yields the traces there, the best ones first.
template <class Element, class TracesOf, class Use>
void at_curved_walls(const Element& element, const State& state, const Goal& goal, const TracesOf& traces_of,
                     const Use& use) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  for (std::size_t f = 0; f < domain.faces.size(); ++f) {
    const auto patch = domain.faces[f].patch;
    const auto& b = problem.boundary_of(domain.faces[f]);
    const auto* surface = domain.mesh->info.surface_of(patch);
    if (!is_curved_wall(b, surface)) continue;
    // nodal charges of first order do not tell the sides of a sheet apart, given ones those of second
    if (domain.faces[f].is_inside && (Element::has_lumped_walls || b.holds_charge())) continue;
    const auto face = element.face(f);
    const auto traces_of_point = traces_of(face, b);
    const double size = std::sqrt(domain.faces[f].area);
    FaceShape sum;
    GapWave wave;
    face.at_points([&](const auto& point) {
      const WallPlace place{point.position, point.normal, point.area};
      const auto shift = wall_shift(domain, b, *surface, place, size);
      const auto change = [&](const WallTraces& traces) {
        return point.area * shape_change(problem, goal, b, traces, shift);
      };
      const auto traces = traces_of_point(point);
      const double here = change(traces[0]);
      for (std::size_t k = 1; k < traces.size(); ++k) {
        const double more = change(traces[k]) - here;
        sum.drift += more;
        sum.spread += std::abs(more);
      }
      sum.change += here;
      sum.squares += shift.distance * here;
      wave.add(domain, *surface, place, shift.distance);
    });
    sum.squares *= wave.number();
    use(at(domain.faces[f].cell), sum);
  }
}

}  // namespace

ShapeError shape_error(const par::Comm& comm, const State& state, const GoalFunctional& functional,
                       std::span<const double> w, const DualGradient& dual) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  const auto traces_of = [&](const LinearElement::Face& face, const Boundary& b) {
    const auto& on = domain.faces[face.number];
    std::array<WallTraces, 2> traces;
    traces[0] = traces_at(state, on, b, dual.of_cells[at(on.cell)]);
    traces[0].counted = functional.counts(on.patch) ? 1 : 0;
    traces[1] = traces[0];
    traces[1].gradient = mean_of(state.recovered, on) + Vec3{0, 0, traces[0].base};
    traces[1].dual_gradient = Vec3{};
    const auto& nodes = domain.mesh->cell_to_node[at(on.cell)];
    for (std::size_t k = 0; k < nodes.size(); ++k)
      if (std::find(on.node.begin(), on.node.end(), nodes[k]) != on.node.end())
        traces[1].dual_gradient += (1.0 / 3) * dual.recovered_in(at(on.cell), k, at(nodes[k]));
    const auto u = face.values(state.u), of_w = face.values(w);
    return [&problem, &face, traces, u, of_w](const LinearElement::Face::Point& point) {
      auto result = traces;
      for (auto& here : result) {
        here.u = interpolated(point.value, u);
        here.psi0 = face.split_potential(problem, point);
        here.w = interpolated(point.value, of_w);
      }
      return result;
    };
  };
  std::array<par::ExactSum, 3> sums;
  at_curved_walls(LinearElement(domain), state, functional.goal, traces_of, [&](std::size_t, const FaceShape& of_face) {
    sums[0].add(of_face.change);
    sums[1].add(of_face.drift);
    sums[2].add(of_face.squares);
  });
  const auto totals = par::reproducible_sums(comm, sums);
  return {totals[0], std::abs(totals[1]) + std::abs(totals[2])};
}

double shape_error(const par::Comm& comm, const State& state, const GoalFunctional& functional, CubicGoalError& dual) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  const auto& functions = state.cubic->functions();
  const GoalSpace<QuadraticElement> space(state);
  const auto traces_of = [&](const QuadraticElement::Face& face, const Boundary& b) {
    const auto c = at(domain.faces[face.number].cell);
    const auto of_second = at_nodes(domain.quadratic->cell_to_node[c], state.u);
    const auto error = functions.values(c, state.cubic->error()), all = functions.values(c, dual.dual);
    auto value = error, added = all;  // what third order adds to the dual solution
    for (std::size_t k = 0; k < 10; ++k) {
      value[k] += of_second[k];
      added[k] = 0;
    }
    const double rest_u = state.cubic->decay()[c], rest_w = dual.decay[c];
    const double counted = functional.counts(domain.faces[face.number].patch) ? 1 : 0;
    return [&problem, &face, &b, &space, error, all, value, added, rest_u, rest_w,
            counted](const QuadraticElement::Face::Point& point) {
      const auto behind = space.behind(face, point);
      const double psi0 = face.split_potential(problem, point), base = face.split_slope(problem, point);
      const bool is_given = b.condition == Condition::potential;
      std::array<WallTraces, 3> traces;
      traces.fill({point.normal, gradient_of(behind, value) + Vec3{0, 0, base},
                   is_given ? b.value - psi0 : interpolated(behind.value, value), psi0, base, gradient_of(behind, all),
                   interpolated(behind.value, all), counted});
      traces[1].gradient += rest_u * gradient_of(behind, error);
      if (!is_given) traces[1].u += rest_u * interpolated(behind.value, error);
      traces[2].dual_gradient += rest_w * gradient_of(behind, added);
      traces[2].w += rest_w * interpolated(behind.value, added);
      return traces;
    };
  };
  std::array<par::ExactSum, 1> sum;
  at_curved_walls(QuadraticElement(domain), state, functional.goal, traces_of,
                  [&](std::size_t cell, const FaceShape& of_face) {
                    sum[0].add(of_face.change);
                    dual.rest.add(cell, of_face.squares, of_face.spread);
                  });
  dual.rest.unsolved += charge_at_edges(comm, state, functional.counted, dual.dual);
  return par::reproducible_sums(comm, sum)[0];
}

}  // namespace pamr::poisson_boltzmann
