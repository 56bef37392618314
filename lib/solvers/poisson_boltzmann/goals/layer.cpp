// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/layer.hpp"

#include <algorithm>
#include <cmath>

#include "pamr/base/index.hpp"

namespace pamr::poisson_boltzmann {

namespace {

/// Potentials that the patches would have as flat walls alone in the liquid, by their charges; 0 where they have none.
/// A charge makes such a potential when its layer is resolved; the solution tells less where it is not.
std::vector<double> potentials_of_charges(const Problem& problem) {
  std::vector<double> result;
  for (const auto& patch : problem.domain.mesh->info.patches) {
    const auto* b = problem.input.find_boundary(patch.name);
    auto& potential = result.emplace_back(0);
    if (b == nullptr) continue;
    if (b->condition == Condition::charge) potential = problem.term.potential_of_charge(b->charge_at(0));
    if (b->condition == Condition::regulated) potential = b->site.flat_wall_potential(problem.term);
  }
  return result;
}

/// Thickness of the layer at a face, by the potential of its nodes and that of its charge.
double thickness_at(const State& state, const BoundaryFace& face, double of_charge) {
  const auto& problem = state.problem;
  double thinnest = problem.term.layer_thickness(of_charge);
  const auto take = [&](double potential) { thinnest = std::min(thinnest, problem.term.layer_thickness(potential)); };
  for (const auto node : face.node) take(problem.conditions.psi0[at(node)] + state.u[at(node)]);
  return thinnest;
}

}  // namespace

Layers find_layers(const par::Comm& comm, const State& state, double max_cells) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  const auto& patches = domain.mesh->info.patches;
  Layers result{std::vector<Layer>(patches.size()), std::vector<double>(domain.mesh->cell_to_node.size(), 0)};
  std::vector<par::ExactSum> sums(3 * patches.size());
  std::vector<double> thinnest(patches.size(), HUGE_VAL);
  for (std::size_t p = 0; p < patches.size(); ++p)
    result.patches[p].is_known = problem.input.split && patches[p].name == problem.input.plate->patch;
  const auto of_charge = potentials_of_charges(problem);
  for (const auto& face : domain.faces) {
    const auto p = at(face.patch);
    if (!problem.input.is_electrode(patches[p].name) || !(face.area > 0)) continue;
    const double thickness = thickness_at(state, face, of_charge[p]);
    const double height = 3 * geometry::volume(domain.points(at(face.cell))) / face.area;
    const double ratio = height / thickness;
    sums[3 * p].add(face.weight() * face.area * height * height);
    sums[3 * p + 1].add(face.weight() * face.area * ratio * ratio);
    sums[3 * p + 2].add(face.area / (thickness * thickness));
    thinnest[p] = std::min(thinnest[p], thickness);
    auto& cell = result.cell_ratio[at(face.cell)];
    if (!result.patches[p].is_known) cell = std::max(cell, ratio);
  }
  const auto totals = par::reproducible_sums(comm, sums);
  for (std::size_t p = 0; p < patches.size(); ++p) {
    auto& layer = result.patches[p];
    const double area = domain.patches[p].area;
    thinnest[p] = comm.min(thinnest[p]);
    if (!(area > 0) || !problem.input.is_electrode(patches[p].name)) continue;
    layer.thickness = thinnest[p];
    layer.height = std::sqrt(totals[3 * p] / area);
    layer.ratio = std::sqrt(totals[3 * p + 1] / area);
    layer.n_cells = 10 * totals[3 * p + 2];
    layer.is_lost = layer.ratio > largest_layer_ratio || (!layer.is_resolved() && layer.n_cells > max_cells);
  }
  return result;
}

}  // namespace pamr::poisson_boltzmann
