// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/free_energy.hpp"

#include <array>

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/fem/site_walls.hpp"

namespace pamr::poisson_boltzmann {

namespace {

/// Adds half of the integral of alpha u^2 over the faces of the far field: the energy beyond them.
template <class Element>
void add_far_field(const Element& element, const State& state, par::ExactSum& sum) {
  const auto& problem = state.problem;
  const auto& faces = element.domain.faces;
  for (std::size_t f = 0; f < faces.size(); ++f) {
    if (problem.boundary_of(faces[f]).condition != Condition::far_field) continue;
    const auto face = element.face(f);
    const auto value = face.values(state.u);
    double of_face = 0;
    face.at_wall_points([&](const auto& point) {
      const double u = interpolated(point.value, value);
      of_face += 0.5 * point.area * far_field_coefficient(problem.input.spheres, point.middle, point.normal) * u * u;
    });
    sum.add(of_face);
  }
}

}  // namespace

std::optional<FreeEnergy> free_energy_of(const par::Comm& comm, const State& state, const Energy& energy) {
  const auto& problem = state.problem;
  if (problem.input.plate || problem.input.manufactured) return std::nullopt;
  // Beyond the far field; charges times potentials, given ones alone and all of them; sites.
  std::array<par::ExactSum, 4> sums;
  with_element(problem.domain, [&](const auto& element) { add_far_field(element, state, sums[0]); });
  const auto& conditions = problem.conditions;
  for (std::size_t i = 0; i < state.u.size(); ++i) {
    if (!problem.domain.nodes.is_owned(i)) continue;
    const double held = conditions.fixed[i] != 0 ? state.reaction[i] : 0;
    sums[1].add(conditions.load[i] * state.u[i]);
    sums[2].add((conditions.load[i] + held) * state.u[i]);
  }
  at_site_points(problem, state.u, [&](const SitePoint& point) {
    sums[2].add(point.area * point.site->value(point.psi) * point.psi);
    sums[3].add(point.area * point.site->integral(point.psi));
  });
  const auto totals = par::reproducible_sums(comm, sums);
  const double fixed_potential = -(energy.total + totals[0]);
  return FreeEnergy{fixed_potential, fixed_potential + totals[2], fixed_potential + totals[1] + totals[3]};
}

}  // namespace pamr::poisson_boltzmann
