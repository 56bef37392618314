// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/surface_force.hpp"

#include <array>

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/fem/elements.hpp"
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
  bool has_inside = false;
  Layer layer{.is_known = true};

  void add(const FaceTotals& other) {
    raw += other.raw;
    recovered += other.recovered;
    reaction += other.reaction;
    charge += other.charge;
    potential += other.potential;
    area += other.area;
    is_fixed = is_fixed && other.is_fixed;
    has_inside = has_inside || other.has_inside;
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
template <class Element>
void add_face(const Element& element, const State& state, std::size_t f, FaceSums& sums) {
  const auto& problem = state.problem;
  const auto& domain = problem.domain;
  const auto& b = problem.boundary_of(domain.faces[f]);
  const auto face = element.face(f);
  const auto value = face.values(state.u);
  const auto behind = face.behind(state.u);
  double charge = 0, potential = 0;
  Vec3 raw, recovered, reaction;
  face.at_wall_points([&](const auto& point) {
    const double u = interpolated(point.value, value), psi0 = face.split_potential(problem, point);
    const double pressure = problem.term.pressure(u, psi0);
    const Vec3 n = -point.normal;  // from the body into the liquid
    const Vec3 base{0, 0, problem.split_slope(point.position.z)};
    const auto stress_of = [&](Vec3 gradient, Vec3 of_profile) {
      return point.area * (added_stress(gradient, of_profile, n) - pressure * n);
    };
    raw += stress_of(behind.gradient(point), {0, 0, face.split_slope(problem, point)});
    recovered += stress_of(interpolated(point.value, face.nodes, state.recovered), base);
    double density = outward_slope(problem, b, point, u, psi0);
    if constexpr (Element::has_lumped_walls) {
      if (fixes_potential(b.condition))
        density = reaction_charge(problem, state.reaction, point.normal, at(face.nodes[point.index])).value_or(density);
      reaction += stress_of(-density * n - base, base);
    }
    charge += point.area * density;
    potential += domain.faces[f].weight() * point.area * (psi0 + u);
  });
  sums.raw.add(raw);
  sums.recovered.add(recovered);
  sums.reaction.add(reaction);
  sums.charge_and_potential[0].add(charge);
  sums.charge_and_potential[1].add(potential);
}

/// Totals of each patch of the mesh. Of second order nodal charges have no density at a node: they count to the patch
/// that decides the node, and the form by reactions is left out. Collective: exact sums.
template <class Element>
std::vector<FaceTotals> totals_of_patches(const Element& element, const par::Comm& comm, const State& state,
                                          const Layers& layers) {
  const auto& domain = element.domain;
  const auto& patches = domain.mesh->info.patches;
  std::vector<FaceSums> sums(patches.size());
  for (std::size_t f = 0; f < domain.faces.size(); ++f) add_face(element, state, f, sums[at(domain.faces[f].patch)]);
  const auto& deciding = state.problem.conditions.deciding_patch;
  if (!Element::has_lumped_walls)
    for (const auto node : domain.nodes.owned())
      if (deciding[at(node)] >= 0) sums[at(deciding[at(node)])].charge_and_potential[0].add(state.reaction[at(node)]);
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
    totals.is_fixed = Element::has_lumped_walls && b != nullptr && b->condition == Condition::potential;
    totals.has_inside = domain.patches[p].has_inside;
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
  if (totals.has_inside) return result;  // means at nodes mix the two sides
  result.surface_recovered = mirrors.complete(totals.recovered);
  if (totals.is_fixed) result.surface_reaction = mirrors.complete(totals.reaction);
  return result;
}

}  // namespace

double outward_slope(const Problem& problem, const Boundary& b, const PlacedFacePoint& point, double u, double psi0) {
  const double z = point.position.z;
  switch (b.condition) {
    case Condition::charge:
    case Condition::regulated:
      return b.charge_at(psi0 + u);
    case Condition::symmetry:
      return 0;
    case Condition::far_field:
      return point.normal.z * problem.profile.slope(z) -
             far_field_coefficient(problem.input.spheres, point.middle, point.normal) *
                 (u - (problem.input.split ? 0 : problem.profile.potential(z)));
    default:
      return point.normal.z * problem.split_slope(z);
  }
}

std::vector<PatchResult> surface_results(const par::Comm& comm, const State& state,
                                         std::span<const Electrode> electrodes, const Layers& layers) {
  const auto& patches = state.problem.domain.mesh->info.patches;
  const auto totals = with_element(
      state.problem.domain, [&](const auto& element) { return totals_of_patches(element, comm, state, layers); });
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
