// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/functionals.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/listed.hpp"
#include "solvers/poisson_boltzmann/fem/site_walls.hpp"
#include "solvers/poisson_boltzmann/goals/cut_off.hpp"
#include "solvers/poisson_boltzmann/goals/goal_space.hpp"
#include "solvers/poisson_boltzmann/goals/volume_force.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

/// Where the layer of a body is not resolved at all, the potential beyond it is too high as well, and with it every
/// form of the force and the charges of patches without a body. The goals keep their derivatives, so that marking by
/// them goes on.
void withdraw_lost_values(Functionals& result) {
  bool any = false;
  for (auto& patch : result.patches) {
    if (patch.electrode == nullptr || !patch.layer.is_lost || patch.layer.is_known) continue;
    any = true;
    patch.volume.reset();
    patch.torque.reset();
    patch.midplane.reset();
    patch.no_volume = "its layer is not resolved";
    for (auto& goal : result.goals)
      if (goal.goal.body == patch.name) goal.value.reset();
  }
  if (!any) return;
  for (auto& patch : result.patches) {
    if (patch.electrode != nullptr) continue;
    patch.charge.reset();
    patch.charge_density.reset();
  }
  for (auto& goal : result.goals)
    if (goal.goal.body.empty()) goal.value.reset();
}

PatchResult& result_named(const std::string& name, Functionals& result) {
  return *std::find_if(result.patches.begin(), result.patches.end(),
                       [&](const PatchResult& patch) { return patch.name == name; });
}

/// `squares` are J''(e, e)/2 on cells. With the dual solution of the derivative at u_h, which that of second order is,
///
///     J(u) - J(u_h) = J'(u_h)e + J''(e, e)/2 = J'(u)e - J''(e, e)/2.
///
/// Recovered gradients are smooth: of first order they are those of the dual solution of the derivative at u, which has
/// a smooth stress, while that of u_h jumps from cell to cell. Bars of second order need the parts of cells as well.
/// Collective.
void set_remainder(const par::Comm& comm, const State& state, std::vector<double> squares, GoalFunctional& goal) {
  const bool is_linear = state.cubic == nullptr;
  goal.remainder = (is_linear ? -1 : 1) * par::reproducible_sum(comm, squares);
  if (!is_linear) goal.squares = std::move(squares);
}

void set_volume_goal(const par::Comm& comm, const State& state, const Electrode& electrode, const PatchResult& patch,
                     const CutOff& cut_off, GoalFunctional& goal) {
  const bool is_torque = goal.goal.kind == Goal::Kind::torque;
  if (!is_torque && goal.goal.kind != Goal::Kind::force) return;
  const auto axis = at(goal.goal.axis);
  const auto& mirrors = electrode.mirrors;
  goal.value = is_torque ? (*patch.torque)[axis] : (*patch.volume)[axis];
  const bool has_walls = with_element(
      state.problem.domain, [&](const auto& element) { return decltype(goal_space(element, state))::has_walls; });
  goal.through_walls = is_torque || has_walls ? 0 : patch.through_walls[axis];
  goal.factor = mirrors.factor;
  goal.component = {goal.goal.axis, is_torque, electrode.center};
  if (state.cubic == nullptr) goal.cut_off = cut_off.chi;
  goal.load = volume_form_derivative(comm, state, cut_off.chi, cut_off.open_walls, goal.component);
  set_remainder(comm, state, volume_form_remainder(state, cut_off.chi, cut_off.open_walls, goal.component), goal);
}

void add_volume_form(const par::Comm& comm, const State& state, System& system, const Electrode& electrode,
                     Functionals& result) {
  auto& patch = result_named(electrode.name, result);
  const auto cut_off = make_cut_off(comm, state.problem, system, electrode);
  patch.no_volume = cut_off.reason;
  patch.inner = cut_off.inner;
  patch.outer = cut_off.outer;
  std::optional<VolumeForm> form;
  if (cut_off.reason.empty()) {
    form = volume_form(comm, state, cut_off.chi, cut_off.open_walls, electrode.center);
    patch.volume = electrode.mirrors.complete(form->force);
    patch.torque = electrode.mirrors.complete_torque(form->torque);
    patch.through_walls = electrode.mirrors.complete(form->through_walls);
  }
  for (auto& goal : result.goals)
    if (goal.goal.body == electrode.name) set_volume_goal(comm, state, electrode, patch, cut_off, goal);
}

/// The force through the mirror acts on everything on this side that does not reach through it: on one body, if all
/// electrodes that the mirror does not cut are its patches.
void add_midplane_form(const par::Comm& comm, const State& state, const Excess& excess,
                       const std::vector<Electrode>& electrodes, Functionals& result) {
  const auto& domain = state.problem.domain;
  const auto& name = state.problem.input.force.midplane;
  if (name.empty()) return;
  const int number = domain.patch_number(name);
  const auto& shape = domain.patches[at(number)];
  const double factor = state.mirrors[at(number)].factor;
  const double force = factor * midplane_force(comm, state, excess, number);
  double outward = 0;
  for (const auto& face : domain.faces)
    if (face.patch == number) outward = face.normal[at(shape.axis)];
  Vec3 direction;
  direction[at(shape.axis)] = comm.max(outward) > 0 ? -1 : 1;

  std::uint64_t pushed = 0;
  for (const auto& electrode : electrodes)
    if ((electrode.mirrors.neighbors >> static_cast<unsigned>(number) & 1U) == 0) pushed |= electrode.patches;
  auto* patch = &result_named(name, result);
  std::vector<std::string> names;
  for (const auto& electrode : electrodes) {
    if (electrode.patches == pushed) patch = &result_named(electrode.name, result);
    const bool is_part = (electrode.patches & ~pushed) == 0 && domain.patch_number(electrode.name) >= 0;
    if (is_part) names.push_back(electrode.name);
  }
  patch->midplane = force * direction;
  if (patch->electrode == nullptr && !names.empty())
    result.no_midplane = fmt::format("what passes the mid-plane acts on all of {} together, not on one of them",
                                     listed(names, {.most = all_items}));
  for (auto& goal : result.goals) {
    if (goal.goal.kind != Goal::Kind::midplane) continue;
    goal.value = force;
    goal.factor = factor;
    goal.load = midplane_derivative(comm, state, excess, number);
    set_remainder(comm, state, midplane_remainder(state, excess, number), goal);
  }
}

/// Derivative of the charge of the sites that the goal counts, with the other sign, and the square of the error in it.
/// Collective: an exchange and an exact sum.
void set_site_goal(const par::Comm& comm, const State& state, GoalFunctional& goal) {
  const auto& domain = state.problem.domain;
  std::vector<double> squares(domain.mesh->cell_to_node.size(), 0);
  goal.load = with_element(domain, [&](const auto& element) {
    auto space = goal_space(element, state);
    at_site_points(state.problem, state.u, [&](const SitePoint& point) {
      const auto& face = domain.faces[point.face];
      if (!goal.counts(face.patch)) return;
      space.add_on_face(point.face, point, -point.area * point.site->slope(point.psi));
      const double error = space.error_on_face(point.face, point.index);
      squares[at(face.cell)] += 0.5 * point.area * point.site->curvature(point.psi) * error * error;
    });
    return space.total(comm);
  });
  set_remainder(comm, state, std::move(squares), goal);
}

void set_charge_goal(const par::Comm& comm, const State& state, const std::vector<Electrode>& electrodes,
                     const std::vector<PatchResult>& results, GoalFunctional& goal) {
  const auto& problem = state.problem;
  const auto& deciding = problem.conditions.deciding_patch;
  const auto electrode =
      std::find_if(electrodes.begin(), electrodes.end(), [&](const Electrode& e) { return e.name == goal.goal.body; });
  const bool is_body = electrode != electrodes.end();
  goal.load.assign(deciding.size(), 0);
  goal.fixed.assign(deciding.size(), 0);
  const auto& patches = problem.domain.mesh->info.patches;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const bool is_part = is_body ? electrode->has(static_cast<int>(p)) : patches[p].name == goal.goal.body;
    for (std::size_t i = 0; i < deciding.size(); ++i)
      if (is_part && deciding[i] == static_cast<int>(p)) goal.fixed[i] = 1;
    if (is_part && problem.input.find_boundary(patches[p].name)->condition == Condition::regulated)
      goal.counted |= std::uint64_t{1} << p;
  }
  if (goal.counted != 0) set_site_goal(comm, state, goal);
  for (const auto& patch : results)
    if (patch.name == goal.goal.body) {
      goal.value = patch.charge;
      goal.factor = patch.symmetry_factor;
    }
}

/// The energy is stationary but for charges of walls and the far field: its derivative is what these add.
void set_energy_goal(const par::Comm& comm, const State& state, const Energy& energy, GoalFunctional& goal) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  goal.value = problem.input.split ? energy.excess : energy.total;
  goal.load = with_element(domain, [&](const auto& element) {
    auto space = goal_space(element, state);
    for (std::size_t f = 0; f < domain.faces.size(); ++f) {
      const auto& b = problem.boundary_of(domain.faces[f]);
      if (!b.holds_charge() && b.condition != Condition::far_field) continue;
      const auto face = element.face(f);
      const auto value = face.values(state.u);
      face.at_wall_points([&](const auto& point) {
        const double u = interpolated(point.value, value), psi0 = face.split_potential(problem, point);
        space.add_on_face(f, point, point.area * outward_slope(problem, b, point, u, psi0));
      });
    }
    return space.total(comm);
  });
  const auto& fixed = problem.conditions.fixed;
  for (std::size_t i = 0; i < fixed.size(); ++i)
    if (fixed[i] != 0) goal.load[i] = 0;
}

/// The mirrors must leave that component of a force or torque, and the body must have a volume form.
void require_component(const Problem& problem, const Goal& goal, const Electrode& electrode) {
  const auto axis = at(goal.axis);
  const auto reason = no_cut_off(problem, electrode);
  if (!reason.empty())
    throw Error(fmt::format("expected a body that has a volume form for goal \"{}\", found \"{}\": {}", goal.name,
                            electrode.name, reason));
  const auto& mirrors = electrode.mirrors;
  const bool is_torque = goal.kind == Goal::Kind::torque;
  if (is_torque ? mirrors.complete_torque({1, 1, 1})[axis] == 0 : mirrors.vanishes(axis))
    throw Error(
        fmt::format("expected a component that the mirrors leave for goal \"{}\" of \"{}\", found one that is "
                    "zero by symmetry",
                    goal.name, electrode.name));
}

}  // namespace

void require_goals(const par::Comm& comm, const Problem& problem) {
  const auto& input = problem.input;
  const auto& domain = problem.domain;
  const auto& midplane = input.force.midplane;
  if (!midplane.empty() && domain.patches[at(domain.patch_number(midplane))].axis < 0)
    throw Error(fmt::format("expected a flat mid-plane normal to an axis, found patch \"{}\"", midplane));
  const auto electrodes = find_electrodes(comm, domain, input);
  for (const auto& goal : input.estimator.goals) {
    if (goal.body.empty()) continue;
    const auto electrode = std::find_if(electrodes.begin(), electrodes.end(),
                                        [&](const Electrode& candidate) { return candidate.name == goal.body; });
    if (electrode == electrodes.end())
      throw Error(
          fmt::format("expected a patch that holds a charge, sites or a potential for goal \"{}\", found \"{}\"",
                      goal.name, goal.body));
    if (goal.kind != Goal::Kind::charge) {
      require_component(problem, goal, *electrode);
      continue;
    }
    for (std::size_t p = 0; p < domain.patches.size(); ++p)
      if (electrode->has(static_cast<int>(p)) &&
          input.find_boundary(domain.mesh->info.patches[p].name)->condition == Condition::charge)
        throw Error(
            fmt::format("expected a patch or body of given potential, or a regulated one, for goal \"charge\", found "
                        "\"{}\"",
                        goal.body));
  }
}

Functionals find_functionals(const par::Comm& comm, const State& state, System& system,
                             const std::vector<Electrode>& electrodes, const Layers& layers) {
  const auto excess = excess_of(state);
  Functionals result;
  result.patches = surface_results(comm, state, electrodes, layers);
  for (const auto& goal : state.problem.input.estimator.goals) result.goals.emplace_back().goal = goal;
  for (const auto& electrode : electrodes) add_volume_form(comm, state, system, electrode, result);
  add_midplane_form(comm, state, excess, electrodes, result);
  result.energy = energy_of(comm, state, excess);
  for (auto& goal : result.goals) {
    if (goal.goal.kind == Goal::Kind::charge) set_charge_goal(comm, state, electrodes, result.patches, goal);
    if (goal.goal.kind == Goal::Kind::energy) set_energy_goal(comm, state, result.energy, goal);
  }
  withdraw_lost_values(result);
  return result;
}

}  // namespace pamr::poisson_boltzmann
