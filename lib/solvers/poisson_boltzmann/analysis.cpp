// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/analysis.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pamr/base/error.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "solvers/poisson_boltzmann/quadrature.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

/// The sphere that has this patch; null where none has.
const Sphere* sphere_of(const Case& problem, std::string_view patch) {
  for (const auto& sphere : problem.spheres)
    if (!sphere.patch.empty() && sphere.patch == patch) return &sphere;
  return nullptr;
}

int axis_of(const std::string& goal) { return goal.back() - 'x'; }

/// The functional of the goal: its value on full bodies, the factor of the symmetry, and what the dual system needs.
struct Goal {
  double value = 0, factor = 1;
  std::vector<double> load, fixed;
};

class Analyst {
 public:
  Analyst(const par::Comm& comm, const Domain& domain, const Case& problem, const Conditions& conditions,
          System& system, const Solution& solution)
      : comm_(comm),
        domain_(domain),
        problem_(problem),
        conditions_(conditions),
        system_(system),
        solution_(solution),
        term_(problem.linear),
        gradient_(cell_gradients(domain, solution.u)),
        recovered_(recover(comm, domain, gradient_, problem.estimator.recovery)),
        mirrors_(find_mirrors(comm, domain, problem)),
        state_{domain, problem, conditions, solution.u, solution.reaction, gradient_, recovered_, mirrors_} {}

  Analysis run() {
    Analysis result;
    result.psi.resize(solution_.u.size());
    result.field.resize(solution_.u.size());
    const auto profile = problem_.profile();
    for (std::size_t i = 0; i < result.psi.size(); ++i) {
      result.psi[i] = conditions_.psi0[i] + solution_.u[i];
      const double slope = problem_.split ? profile.slope(domain_.point[i].z) : 0;
      result.field[i] = -(recovered_[i] + Vec3{0, 0, slope});
    }
    result.estimate = estimate_error(comm_, domain_, term_, solution_.u, conditions_.psi0, gradient_, recovered_);
    result.patches = surface_results(comm_, state_);
    add_volume_forms(result);
    add_midplane_form(result);
    result.energy = energy_of(comm_, state_);
    if (problem_.manufactured) compare_with_manufactured(result);
    if (problem_.estimator.goal != "none") add_goal(result);
    return result;
  }

 private:
  void add_volume_forms(Analysis& result) {
    for (std::size_t p = 0; p < result.patches.size(); ++p) {
      auto& patch = result.patches[p];
      const auto* sphere = sphere_of(problem_, patch.name);
      std::optional<CutOff> cut_off;
      if (sphere != nullptr) cut_off = make_cut_off(comm_, state_, *sphere, static_cast<int>(p));
      if (problem_.plate && patch.name == problem_.plate->patch) cut_off = make_plate_cut_off(comm_, state_);
      if (!cut_off) continue;
      patch.inner = cut_off->inner;
      patch.outer = cut_off->outer;
      patch.volume = mirrors_[p].complete(volume_force(comm_, state_, cut_off->chi));
    }
  }

  /// Force per meshed part of the mirror, and the direction in which it pushes what lies on this side.
  void add_midplane_form(Analysis& result) {
    if (problem_.force.midplane.empty()) return;
    const int mirror = domain_.patch_number(problem_.force.midplane);
    const auto& shape = domain_.patches[static_cast<std::size_t>(mirror)];
    if (shape.axis < 0)
      throw Error(
          fmt::format("expected a flat mid-plane normal to an axis, found patch \"{}\"", problem_.force.midplane));
    const double force = midplane_factor() * midplane_force(comm_, state_, mirror);
    double sign = 0;
    for (const auto& face : domain_.faces)
      if (face.patch == mirror)
        sign = shape.axis == 0 ? face.normal.x : shape.axis == 1 ? face.normal.y : face.normal.z;
    sign = comm_.max(sign) > 0 ? -1 : 1;
    Vec3 direction{shape.axis == 0 ? sign : 0, shape.axis == 1 ? sign : 0, shape.axis == 2 ? sign : 0};
    std::size_t n_bodies = 0;
    for (const auto& patch : result.patches) n_bodies += sphere_of(problem_, patch.name) != nullptr ? 1 : 0;
    // With one body on this side the force is that body's; with several it is that of all together.
    for (auto& patch : result.patches)
      if (n_bodies == 1 ? sphere_of(problem_, patch.name) != nullptr : patch.name == problem_.force.midplane)
        patch.midplane = force * direction;
  }

  double midplane_factor() const {
    return mirrors_[static_cast<std::size_t>(domain_.patch_number(problem_.force.midplane))].factor;
  }

  void compare_with_manufactured(Analysis& result) {
    const auto& cells = domain_.mesh->cell_to_node;
    std::array<par::ExactSum, 2> sums;
    for (std::size_t c = 0; c < cells.size(); ++c) {
      const auto p = domain_.points(c);
      const double volume = geometry::volume(p);
      for (const auto& at : gauss_points) {
        Vec3 point;
        double value = 0;
        for (std::size_t k = 0; k < 4; ++k) {
          point = point + at.weight_of_corner[k] * p[k];
          value += at.weight_of_corner[k] * solution_.u[static_cast<std::size_t>(cells[c][k])];
        }
        const double error = value - manufactured_potential(point);
        sums[0].add(volume * at.weight * error * error);
        sums[1].add(volume * at.weight * squared_norm(gradient_[c] - manufactured_gradient(point)));
      }
    }
    const auto totals = par::reproducible_sums(comm_, sums);
    result.manufactured_l2 = std::sqrt(totals[0]);
    result.manufactured_h1 = std::sqrt(totals[1]);
  }

  Goal make_goal(const Analysis& result) {
    const auto& options = problem_.estimator;
    Goal goal;
    if (options.goal == "midplane") {
      const int mirror = domain_.patch_number(problem_.force.midplane);
      goal.factor = midplane_factor();
      goal.value = goal.factor * midplane_force(comm_, state_, mirror);
      goal.load = midplane_derivative(comm_, state_, mirror);
      return goal;
    }
    const auto p = static_cast<std::size_t>(domain_.patch_number(options.goal_patch));
    goal.factor = mirrors_[p].factor;
    if (options.goal == "charge") {
      goal.value = result.patches[p].charge;
      goal.load.assign(domain_.point.size(), 0);
      goal.fixed.assign(domain_.point.size(), 0);
      for (std::size_t i = 0; i < goal.fixed.size(); ++i)
        if (conditions_.deciding_patch[i] == static_cast<int>(p)) goal.fixed[i] = 1;
      return goal;
    }
    const auto* sphere = sphere_of(problem_, options.goal_patch);
    if (sphere == nullptr)
      throw Error(fmt::format("expected goal_patch to be the patch of a sphere for goal \"{}\", found \"{}\"",
                              options.goal, options.goal_patch));
    const int axis = axis_of(options.goal);
    const auto cut_off = make_cut_off(comm_, state_, *sphere, static_cast<int>(p));
    if (!cut_off)
      throw Error(
          fmt::format("expected room for a cut-off function round sphere \"{}\", found a boundary that touches it",
                      options.goal_patch));
    const auto force = mirrors_[p].complete(volume_force(comm_, state_, cut_off->chi));
    goal.value = axis == 0 ? force.x : axis == 1 ? force.y : force.z;
    goal.load = volume_force_derivative(comm_, state_, cut_off->chi, axis);
    return goal;
  }

  void add_goal(Analysis& result) {
    const auto goal = make_goal(result);
    const auto w = system_.solve_linearised(goal.load, goal.fixed);
    const auto gradient = cell_gradients(domain_, w);
    const auto recovered = recover(comm_, domain_, gradient, problem_.estimator.recovery);
    auto error = goal_error(comm_, domain_, term_,
                            {solution_.u, conditions_.psi0, w, gradient_, recovered_, gradient, recovered},
                            problem_.solver.quadrature == Quadrature::nodal);
    result.goal_correction = goal.factor * error.correction;
    result.goal = std::move(error.share);
    result.goal_value = goal.value;
    result.goal_error = goal.factor * par::reproducible_sum(comm_, result.goal);
  }

  const par::Comm& comm_;
  const Domain& domain_;
  const Case& problem_;
  const Conditions& conditions_;
  System& system_;
  const Solution& solution_;
  SourceTerm term_;
  std::vector<Vec3> gradient_, recovered_;
  std::vector<Mirrors> mirrors_;
  State state_;
};

void put(std::vector<mesh::Field>& fields, mesh::Field field) {
  std::erase_if(fields, [&](const mesh::Field& old) { return old.name == field.name; });
  fields.push_back(std::move(field));
}

mesh::Field scalar(const std::string& name, const std::string& unit, std::vector<double> value) {
  mesh::Field field;
  field.name = name;
  field.unit = unit;
  field.value = std::move(value);
  return field;
}

}  // namespace

Analysis analyze(const par::Comm& comm, const Domain& domain, const Case& problem, const Conditions& conditions,
                 System& system, const Solution& solution) {
  return Analyst(comm, domain, problem, conditions, system, solution).run();
}

void set_fields(mesh::DistMesh& mesh, const Case& problem, const Solution& solution, const Analysis& analysis) {
  for (const auto* name : {"potential", "excess_potential", "electric_field"})
    std::erase_if(mesh.node_fields, [&](const mesh::Field& field) { return field.name == name; });
  for (const auto* name : {"error_squared", "error_ratio", "residual_squared", "indicator", "goal_error"})
    std::erase_if(mesh.cell_fields, [&](const mesh::Field& field) { return field.name == name; });
  put(mesh.node_fields, scalar("potential", "kT/Ze", analysis.psi));
  if (problem.split) put(mesh.node_fields, scalar("excess_potential", "kT/Ze", solution.u));
  std::vector<double> field;
  field.reserve(3 * analysis.field.size());
  for (const auto& v : analysis.field) field.insert(field.end(), {v.x, v.y, v.z});
  auto vector = scalar("electric_field", "kT/Ze per Debye length", std::move(field));
  vector.n_components = 3;
  put(mesh.node_fields, std::move(vector));

  const auto& estimate = analysis.estimate;
  const double share = estimate.norm_squared / static_cast<double>(mesh.info.n_global_cells);
  std::vector<double> ratio(estimate.squared.size(), 0), indicator(estimate.squared.size());
  for (std::size_t c = 0; c < ratio.size(); ++c) {
    if (share > 0) ratio[c] = estimate.squared[c] / share;
    indicator[c] = estimate.squared[c] + estimate.residual_squared[c];
  }
  put(mesh.cell_fields, scalar("error_squared", "", estimate.squared));
  put(mesh.cell_fields, scalar("error_ratio", "", std::move(ratio)));
  put(mesh.cell_fields, scalar("residual_squared", "", estimate.residual_squared));
  put(mesh.cell_fields, scalar("indicator", "", std::move(indicator)));
  if (!analysis.goal.empty()) put(mesh.cell_fields, scalar("goal_error", "", analysis.goal));
}

}  // namespace pamr::poisson_boltzmann
