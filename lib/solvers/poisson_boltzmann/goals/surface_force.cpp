// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/surface_force.hpp"

#include <array>

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/goals/quadratic_analysis.hpp"
#include "solvers/poisson_boltzmann/goals/wall_stress.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

/// The sums of one patch.
struct FaceSums {
  VectorSum raw, recovered, reaction;
  std::array<par::ExactSum, 2> charge_and_potential;
};

/// The same when they are added up, of a patch or of several.
struct FaceTotals {
  Vec3 raw, recovered, reaction;
  double charge = 0, potential = 0, area = 0;
  bool is_fixed = true;  ///< the potential of all is given
  Layer layer{.is_known = true};

  void add(const FaceTotals& other) {
    raw += other.raw;
    recovered += other.recovered;
    reaction += other.reaction;
    charge += other.charge;
    potential += other.potential;
    area += other.area;
    is_fixed = is_fixed && other.is_fixed;
    const bool is_known = layer.is_known && other.layer.is_known;
    const bool is_lost = layer.is_lost || other.layer.is_lost;
    const double n_cells = layer.n_cells + other.layer.n_cells;
    if (other.layer.ratio >= layer.ratio) layer = other.layer;
    layer.is_known = is_known;
    layer.is_lost = is_lost;
    layer.n_cells = n_cells;
  }
};

/// What one boundary face adds to its patch.
class FaceTerms {
 public:
  explicit FaceTerms(const State& state) : state_(state), problem_(state.problem) {
    for (const auto& patch : problem_.domain.mesh->info.patches)
      boundary_.push_back(problem_.input.find_boundary(patch.name));
  }

  void add(const BoundaryFace& face, FaceSums& sums) const {
    const auto& b = *boundary_[at(face.patch)];
    const Vec3 n = -face.normal;  // from the body into the liquid
    const double third = face.area / 3;
    double mean_pressure = 0, charge = 0, potential = 0;
    Vec3 recovered, reaction;
    for (const auto node : face.node) {
      const auto i = at(node);
      const double slope = problem_.split_slope(problem_.domain.point[i].z);
      const double pressure = problem_.term.pressure(state_.u[i], problem_.conditions.psi0[i]);
      mean_pressure += pressure / 3;
      const Vec3 base{0, 0, slope};
      recovered += third * (added_stress(state_.recovered[i], base, n) - pressure * n);
      const auto by_reaction = fixes_potential(b.condition) ? reaction_charge(problem_, state_.reaction, face.normal, i)
                                                            : std::optional<double>();
      const double density = by_reaction ? *by_reaction : outward_slope(b, face, i);
      charge += third * density;
      potential += third * (problem_.conditions.psi0[i] + state_.u[i]);
      reaction += third * (added_stress(-density * n - base, base, n) - pressure * n);
    }
    const Vec3 base{0, 0, problem_.split_slope(face.node)};
    sums.raw.add(face.area * (added_stress(state_.cell_gradient[at(face.cell)], base, n) - mean_pressure * n));
    sums.recovered.add(recovered);
    sums.reaction.add(reaction);
    sums.charge_and_potential[0].add(charge);
    sums.charge_and_potential[1].add(potential);
  }

 private:
  /// dpsi/dn out of the liquid, where the condition gives it.
  double outward_slope(const Boundary& b, const BoundaryFace& face, std::size_t node) const {
    if (b.condition != Condition::far_field) return b.charge_at(problem_.conditions.psi0[node] + state_.u[node]);
    Vec3 middle;
    for (const auto other : face.node) middle += (1.0 / 3) * problem_.domain.point[at(other)];
    const double z = problem_.domain.point[node].z, psi0 = problem_.profile.potential(z);
    const double excess = state_.u[node] - (problem_.input.split ? 0 : psi0);
    return face.normal.z * problem_.profile.slope(z) -
           far_field_coefficient(problem_.input.spheres, middle, face.normal) * excess;
  }

  const State& state_;
  const Problem& problem_;
  std::vector<const Boundary*> boundary_;
};

/// The same of second order, where nodal charges have no density at a node: the form by reactions is left out.
std::vector<FaceTotals> quadratic_totals(const par::Comm& comm, const State& state, const Layers& layers) {
  std::vector<FaceTotals> result;
  for (const auto& surface : quadratic_surfaces(comm, state)) {
    auto& totals = result.emplace_back();
    totals.area = surface.area;
    totals.charge = surface.charge;
    totals.potential = surface.potential;
    totals.raw = surface.raw;
    totals.recovered = surface.recovered;
    totals.layer = layers.patches[result.size() - 1];
    totals.is_fixed = false;
  }
  return result;
}

/// Totals of each patch of the mesh. Collective: exact sums.
std::vector<FaceTotals> totals_of_patches(const par::Comm& comm, const State& state, const Layers& layers) {
  const auto& domain = state.problem.domain;
  const auto& patches = domain.mesh->info.patches;
  if (domain.quadratic) return quadratic_totals(comm, state, layers);
  std::vector<FaceSums> sums(patches.size());
  const FaceTerms terms(state);
  for (const auto& face : domain.faces) terms.add(face, sums[at(face.patch)]);
  std::vector<FaceTotals> result(patches.size());
  for (std::size_t p = 0; p < patches.size(); ++p) {
    auto& totals = result[p];
    const auto scalars = par::reproducible_sums(comm, sums[p].charge_and_potential);
    totals.charge = scalars[0];
    totals.potential = scalars[1];
    totals.area = domain.patches[p].area;
    totals.raw = sums[p].raw.total(comm);
    totals.recovered = sums[p].recovered.total(comm);
    totals.reaction = sums[p].reaction.total(comm);
    totals.layer = layers.patches[p];
    const auto* b = state.problem.input.find_boundary(patches[p].name);
    totals.is_fixed = b != nullptr && b->condition == Condition::potential;
  }
  return result;
}

PatchResult result_of(const std::string& name, const FaceTotals& totals, const Mirrors& mirrors,
                      const Electrode* electrode) {
  PatchResult result;
  result.name = name;
  result.electrode = electrode;
  result.symmetry_factor = mirrors.factor;
  result.area = totals.area;
  result.layer = totals.layer;
  result.mean_potential = totals.area > 0 ? totals.potential / totals.area : 0;
  // The charge of a plate whose profile is split off is exact but for a small part.
  if (!totals.layer.is_lost || totals.layer.is_known) {
    result.charge = mirrors.factor * totals.charge;
    result.charge_density = totals.area > 0 ? totals.charge / totals.area : 0;
  }
  if (electrode == nullptr || totals.layer.is_lost) return result;
  result.surface = mirrors.complete(totals.raw);
  result.surface_recovered = mirrors.complete(totals.recovered);
  if (totals.is_fixed) result.surface_reaction = mirrors.complete(totals.reaction);
  return result;
}

}  // namespace

std::vector<PatchResult> surface_results(const par::Comm& comm, const State& state,
                                         std::span<const Electrode> electrodes, const Layers& layers) {
  const auto& patches = state.problem.domain.mesh->info.patches;
  const auto totals = totals_of_patches(comm, state, layers);
  std::vector<PatchResult> results;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const Electrode* electrode = nullptr;
    for (const auto& candidate : electrodes)
      if (candidate.name == patches[p].name) electrode = &candidate;
    results.push_back(result_of(patches[p].name, totals[p], state.mirrors[p], electrode));
  }
  for (const auto& electrode : electrodes) {
    if (state.problem.domain.patch_number(electrode.name) >= 0) continue;
    FaceTotals sum;
    for (std::size_t p = 0; p < patches.size(); ++p)
      if (electrode.has(static_cast<int>(p))) sum.add(totals[p]);
    results.push_back(result_of(electrode.name, sum, electrode.mirrors, &electrode));
  }
  return results;
}

}  // namespace pamr::poisson_boltzmann
