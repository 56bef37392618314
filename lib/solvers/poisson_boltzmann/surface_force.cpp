// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/surface_force.hpp"

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/wall_stress.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

/// The sums of one patch.
struct FaceSums {
  VectorSum raw, recovered, reaction;
  par::ExactSum charge;
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
    double mean_slope = 0, mean_pressure = 0, charge = 0;
    Vec3 recovered, reaction;
    for (const auto node : face.node) {
      const auto i = at(node);
      const double slope = problem_.split_slope(problem_.domain.point[i].z);
      const double pressure = problem_.term.pressure(state_.u[i], problem_.conditions.psi0[i]);
      mean_slope += slope / 3;
      mean_pressure += pressure / 3;
      const Vec3 base{0, 0, slope};
      recovered += third * (stress(state_.recovered[i] + base, n) - stress(base, n) - pressure * n);
      const auto by_reaction =
          is_fixed(b) ? reaction_charge(problem_, state_.reaction, face.normal, i) : std::optional<double>();
      const double density = by_reaction ? *by_reaction : outward_slope(b, face, i);
      charge += third * density;
      reaction += third * (stress(density * n, n) - stress(base, n) - pressure * n);
    }
    const Vec3 base{0, 0, mean_slope};
    const Vec3 raw = state_.cell_gradient[at(face.cell)] + base;
    sums.raw.add(face.area * (stress(raw, n) - stress(base, n) - mean_pressure * n));
    sums.recovered.add(recovered);
    sums.reaction.add(reaction);
    sums.charge.add(charge);
  }

  static bool is_fixed(const Boundary& b) {
    return b.condition == Condition::potential || b.condition == Condition::plate_profile ||
           b.condition == Condition::manufactured;
  }

 private:
  /// dpsi/dn out of the liquid, where the condition gives it.
  double outward_slope(const Boundary& b, const BoundaryFace& face, std::size_t node) const {
    if (b.condition == Condition::charge) return b.value;
    if (b.condition != Condition::far_field) return 0;
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

}  // namespace

std::vector<PatchResult> surface_results(const par::Comm& comm, const State& state) {
  const auto& domain = state.problem.domain;
  const auto& patches = domain.mesh->info.patches;
  std::vector<FaceSums> sums(patches.size());
  const FaceTerms terms(state);
  for (const auto& face : domain.faces) terms.add(face, sums[at(face.patch)]);
  std::vector<PatchResult> results;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const auto& mirrors = state.mirrors[p];
    PatchResult result;
    result.name = patches[p].name;
    result.symmetry_factor = mirrors.factor;
    result.area = domain.patches[p].area;
    const double charge = par::reproducible_sums(comm, std::span(&sums[p].charge, 1))[0];
    result.charge = mirrors.factor * charge;
    result.charge_density = result.area > 0 ? charge / result.area : 0;
    result.surface = mirrors.complete(sums[p].raw.total(comm));
    result.surface_recovered = mirrors.complete(sums[p].recovered.total(comm));
    const auto reaction = mirrors.complete(sums[p].reaction.total(comm));
    const auto* b = state.problem.input.find_boundary(patches[p].name);
    if (b != nullptr && b->condition == Condition::potential) result.surface_reaction = reaction;
    results.push_back(result);
  }
  return results;
}

}  // namespace pamr::poisson_boltzmann
