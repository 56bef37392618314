// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/analysis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/require_field.hpp"
#include "solvers/poisson_boltzmann/quadrature.hpp"
#include "solvers/poisson_boltzmann/volume_force.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

/// The sphere that has this patch; null where none has.
const Sphere* sphere_of(const Case& input, std::string_view patch) {
  for (const auto& sphere : input.spheres)
    if (!sphere.patch.empty() && sphere.patch == patch) return &sphere;
  return nullptr;
}

/// Potential and electric field at the nodes.
void add_nodal_fields(const State& state, Analysis& result) {
  const auto& problem = state.problem;
  result.psi.resize(state.u.size());
  result.field.resize(state.u.size());
  for (std::size_t i = 0; i < result.psi.size(); ++i) {
    result.psi[i] = problem.conditions.psi0[i] + state.u[i];
    result.field[i] = -(state.recovered[i] + Vec3{0, 0, problem.split_slope(problem.domain.point[i].z)});
  }
}

/// The volume form of the force on one patch.
struct VolumeForm {
  CutOff cut_off;  ///< `chi` is kept for the patch of the goal only
  Vec3 force;      ///< on full bodies
};

/// Of each patch; nothing for those that are no body or have no room for a cut-off function. Collective.
std::vector<std::optional<VolumeForm>> volume_forms(const par::Comm& comm, const State& state) {
  const auto& input = state.problem.input;
  const auto& patches = state.problem.domain.mesh->info.patches;
  std::vector<std::optional<VolumeForm>> forms(patches.size());
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const auto* sphere = sphere_of(input, patches[p].name);
    std::optional<CutOff> cut_off;
    if (sphere != nullptr) cut_off = make_cut_off(comm, state, *sphere, static_cast<int>(p));
    if (input.plate && patches[p].name == input.plate->patch) cut_off = make_plate_cut_off(comm, state);
    if (!cut_off) continue;
    forms[p] = VolumeForm{std::move(*cut_off), {}};
    auto& chi = forms[p]->cut_off.chi;
    forms[p]->force = state.mirrors[p].complete(volume_force(comm, state, chi));
    if (patches[p].name != input.estimator.goal_patch) chi = {};
  }
  return forms;
}

/// The force through the mirror between two spheres.
struct MidplaneForm {
  int patch = -1;
  double factor = 1;  ///< of the symmetry
  double force = 0;   ///< positive: what lies on this side is pushed away; with the factor
  Vec3 direction;     ///< away from the mirror
};

/// Nothing if the case asks for none. Collective. Throws `Error` when the patch is not flat and normal to an axis.
std::optional<MidplaneForm> midplane_form(const par::Comm& comm, const State& state, const Excess& excess) {
  const auto& domain = state.problem.domain;
  const auto& name = state.problem.input.force.midplane;
  if (name.empty()) return std::nullopt;
  MidplaneForm form;
  form.patch = domain.patch_number(name);
  const auto& shape = domain.patches[at(form.patch)];
  if (shape.axis < 0) throw Error(fmt::format("expected a flat mid-plane normal to an axis, found patch \"{}\"", name));
  form.factor = state.mirrors[at(form.patch)].factor;
  form.force = form.factor * midplane_force(comm, state, excess, form.patch);
  double outward = 0;
  for (const auto& face : domain.faces)
    if (face.patch == form.patch) outward = face.normal[at(shape.axis)];
  form.direction[at(shape.axis)] = comm.max(outward) > 0 ? -1 : 1;
  return form;
}

/// With one body on this side the force is that body's; with several it is that of all together.
void add_midplane_form(const State& state, const MidplaneForm& form, std::vector<PatchResult>& patches) {
  const auto& input = state.problem.input;
  const auto is_body = [&](const PatchResult& patch) { return sphere_of(input, patch.name) != nullptr; };
  const bool is_single = std::count_if(patches.begin(), patches.end(), is_body) == 1;
  for (auto& patch : patches)
    if (is_single ? is_body(patch) : patch.name == input.force.midplane) patch.midplane = form.force * form.direction;
}

/// Errors of u and its gradient against the manufactured solution. Collective.
void compare_with_manufactured(const par::Comm& comm, const State& state, Analysis& result) {
  const auto& domain = state.problem.domain;
  const auto& cells = domain.mesh->cell_to_node;
  std::array<par::ExactSum, 2> sums;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto p = domain.points(c);
    const double volume = geometry::volume(p);
    for (const auto& gauss : gauss_points) {
      Vec3 point;
      double value = 0;
      for (std::size_t k = 0; k < 4; ++k) {
        point += gauss.weight_of_corner[k] * p[k];
        value += gauss.weight_of_corner[k] * state.u[at(cells[c][k])];
      }
      const double error = value - manufactured_potential(point);
      sums[0].add(volume * gauss.weight * error * error);
      sums[1].add(volume * gauss.weight * squared_norm(state.cell_gradient[c] - manufactured_gradient(point)));
    }
  }
  const auto totals = par::reproducible_sums(comm, sums);
  result.manufactured_l2 = std::sqrt(totals[0]);
  result.manufactured_h1 = std::sqrt(totals[1]);
}

/// The functional of the goal: its value on full bodies, the factor of the symmetry, and what the dual system needs.
struct Goal {
  double value = 0, factor = 1;
  std::vector<double> load, fixed;  ///< n_nodes, or empty
};

Goal charge_goal(const State& state, const Analysis& result, std::size_t patch) {
  const auto& deciding = state.problem.conditions.deciding_patch;
  Goal goal{result.patches[patch].charge, state.mirrors[patch].factor, {}, {}};
  goal.load.assign(deciding.size(), 0);
  goal.fixed.assign(deciding.size(), 0);
  for (std::size_t i = 0; i < deciding.size(); ++i)
    if (deciding[i] == static_cast<int>(patch)) goal.fixed[i] = 1;
  return goal;
}

Goal volume_goal(const par::Comm& comm, const State& state, const std::optional<VolumeForm>& form, std::size_t patch) {
  const auto& [recovery, name, patch_name] = state.problem.input.estimator;
  if (sphere_of(state.problem.input, patch_name) == nullptr)
    throw Error(
        fmt::format("expected goal_patch to be the patch of a sphere for goal \"{}\", found \"{}\"", name, patch_name));
  if (!form)
    throw Error(fmt::format(
        "expected room for a cut-off function around sphere \"{}\", found a boundary that touches it", patch_name));
  const int axis = name.back() - 'x';
  return {form->force[at(axis)],
          state.mirrors[patch].factor,
          volume_force_derivative(comm, state, form->cut_off.chi, axis),
          {}};
}

/// Error of the goal by the solution of the dual system. Collective.
void add_goal(const par::Comm& comm, const State& state, System& system, const Goal& goal, Analysis& result) {
  const auto& domain = state.problem.domain;
  const auto& input = state.problem.input;
  const auto w = system.solve_linearised(goal.load, goal.fixed);
  const auto gradient = cell_gradients(domain, w);
  const auto recovered = recover(comm, domain, gradient, input.estimator.recovery);
  auto error =
      goal_error(comm, domain, state.problem.term,
                 {state.u, state.problem.conditions.psi0, w, state.cell_gradient, state.recovered, gradient, recovered},
                 input.solver.quadrature == Quadrature::nodal);
  result.goal_correction = goal.factor * error.correction;
  result.goal = std::move(error.share);
  result.goal_value = goal.value;
  result.goal_error = goal.factor * par::reproducible_sum(comm, result.goal);
}

/// All forms of the forces and the energy go into `result`; returns the goal, if the case has one. Collective.
std::optional<Goal> add_functionals(const par::Comm& comm, const State& state, Analysis& result) {
  const auto& estimator = state.problem.input.estimator;
  const auto excess = excess_of(state);
  result.patches = surface_results(comm, state);
  const auto volume = volume_forms(comm, state);
  for (std::size_t p = 0; p < volume.size(); ++p) {
    if (!volume[p]) continue;
    result.patches[p].volume = volume[p]->force;
    result.patches[p].inner = volume[p]->cut_off.inner;
    result.patches[p].outer = volume[p]->cut_off.outer;
  }
  const auto midplane = midplane_form(comm, state, excess);
  if (midplane) add_midplane_form(state, *midplane, result.patches);
  result.energy = energy_of(comm, state, excess);

  if (estimator.goal == "none") return std::nullopt;
  if (estimator.goal == "midplane")
    return Goal{midplane->force, midplane->factor, midplane_derivative(comm, state, excess, midplane->patch), {}};
  const auto p = at(state.problem.domain.patch_number(estimator.goal_patch));
  return estimator.goal == "charge" ? charge_goal(state, result, p) : volume_goal(comm, state, volume[p], p);
}

mesh::Field scalar(const std::string& name, const std::string& unit, std::vector<double> value) {
  mesh::Field field;
  field.name = name;
  field.unit = unit;
  field.value = std::move(value);
  return field;
}

}  // namespace

Analysis analyze(const par::Comm& comm, const Problem& problem, System& system, const Solution& solution) {
  const auto gradient = cell_gradients(problem.domain, solution.u);
  const auto recovered = recover(comm, problem.domain, gradient, problem.input.estimator.recovery);
  const auto mirrors = find_mirrors(comm, problem.domain, problem.input);
  const State state{problem, solution.u, solution.reaction, gradient, recovered, mirrors};

  Analysis result;
  add_nodal_fields(state, result);
  result.estimate =
      estimate_error(comm, problem.domain, problem.term, solution.u, problem.conditions.psi0, gradient, recovered);
  const auto goal = add_functionals(comm, state, result);
  if (problem.input.manufactured) compare_with_manufactured(comm, state, result);
  if (goal) add_goal(comm, state, system, *goal, result);
  return result;
}

void set_fields(mesh::DistMesh& mesh, const Case& input, const Solution& solution, const Analysis& analysis) {
  for (const auto* name : {"potential", "excess_potential", "electric_field"})
    mesh::remove_field(mesh.node_fields, name);
  for (const auto* name : {"error_squared", "error_ratio", "residual_squared", "indicator", "goal_error"})
    mesh::remove_field(mesh.cell_fields, name);
  mesh::put_field(mesh.node_fields, scalar("potential", "kT/Ze", analysis.psi));
  if (input.split) mesh::put_field(mesh.node_fields, scalar("excess_potential", "kT/Ze", solution.u));
  std::vector<double> field;
  field.reserve(3 * analysis.field.size());
  for (const auto& v : analysis.field) field.insert(field.end(), {v.x, v.y, v.z});
  auto vector = scalar("electric_field", "kT/Ze per Debye length", std::move(field));
  vector.n_components = 3;
  mesh::put_field(mesh.node_fields, std::move(vector));

  const auto& estimate = analysis.estimate;
  const double share = estimate.norm_squared / static_cast<double>(mesh.info.n_global_cells);
  std::vector<double> ratio(estimate.squared.size(), 0), indicator(estimate.squared.size());
  for (std::size_t c = 0; c < ratio.size(); ++c) {
    if (share > 0) ratio[c] = estimate.squared[c] / share;
    indicator[c] = estimate.squared[c] + estimate.residual_squared[c];
  }
  mesh::put_field(mesh.cell_fields, scalar("error_squared", "", estimate.squared));
  mesh::put_field(mesh.cell_fields, scalar("error_ratio", "", std::move(ratio)));
  mesh::put_field(mesh.cell_fields, scalar("residual_squared", "", estimate.residual_squared));
  mesh::put_field(mesh.cell_fields, scalar("indicator", "", std::move(indicator)));
  if (!analysis.goal.empty()) mesh::put_field(mesh.cell_fields, scalar("goal_error", "", analysis.goal));
}

}  // namespace pamr::poisson_boltzmann
