// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/force.hpp"

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

/// Adds up vectors exactly.
struct VectorSum {
  std::array<par::ExactSum, 3> sum;
  void add(Vec3 v) {
    sum[0].add(v.x);
    sum[1].add(v.y);
    sum[2].add(v.z);
  }
  Vec3 total(const par::Comm& comm) {
    const auto values = par::reproducible_sums(comm, sum);
    return {values[0], values[1], values[2]};
  }
};

/// Electric part of the stress on a plane of normal n.
Vec3 stress(Vec3 gradient, Vec3 n) { return dot(gradient, n) * gradient - 0.5 * squared_norm(gradient) * n; }

/// psi - psi0 and psi0 at the nodes, whether or not the case is split.
struct Excess {
  std::vector<double> u, psi0;
};
Excess excess_of(const State& state) {
  Excess result{{state.u.begin(), state.u.end()}, state.conditions.psi0};
  if (state.problem.split || !state.problem.plate) return result;
  const auto profile = state.problem.profile();
  for (std::size_t i = 0; i < result.u.size(); ++i) {
    result.psi0[i] = profile.potential(state.domain.point[i].z);
    result.u[i] -= result.psi0[i];
  }
  return result;
}

/// The sums of one patch.
struct FaceSums {
  VectorSum raw, recovered, reaction;
  par::ExactSum charge;
};

/// What one boundary face adds to its patch.
class FaceTerms {
 public:
  explicit FaceTerms(const State& state)
      : state_(state), profile_(state.problem.profile()), term_(state.problem.linear) {
    for (const auto& patch : state.domain.mesh->info.patches)
      boundary_.push_back(state.problem.find_boundary(patch.name));
  }

  void add(const BoundaryFace& face, FaceSums& sums) const {
    const auto& b = *boundary_[static_cast<std::size_t>(face.patch)];
    const Vec3 n = -face.normal;  // from the body into the liquid
    const bool split = state_.problem.split;
    const double third = face.area / 3;
    double mean_slope = 0, mean_pressure = 0, charge = 0;
    Vec3 recovered, reaction;
    for (const auto node : face.node) {
      const auto i = static_cast<std::size_t>(node);
      const double z = state_.domain.point[i].z, psi0 = state_.conditions.psi0[i], u = state_.u[i];
      const double slope = split ? profile_.slope(z) : 0, pressure = term_.pressure(u, psi0);
      mean_slope += slope / 3;
      mean_pressure += pressure / 3;
      const Vec3 base{0, 0, slope};
      recovered = recovered + third * (stress(state_.recovered[i] + base, n) - stress(base, n) - pressure * n);
      double density = outward_slope(b, face, i);
      if (state_.conditions.fixed[i] != 0 && state_.conditions.fixed_area[i] > 0 && is_fixed(b))
        density = state_.reaction[i] / state_.conditions.fixed_area[i] + face.normal.z * slope;
      charge += third * density;
      reaction = reaction + third * (stress(density * n, n) - stress(base, n) - pressure * n);
    }
    const Vec3 base{0, 0, mean_slope};
    const Vec3 raw = state_.cell_gradient[static_cast<std::size_t>(face.cell)] + base;
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
    for (const auto other : face.node)
      middle = middle + (1.0 / 3) * state_.domain.point[static_cast<std::size_t>(other)];
    const double z = state_.domain.point[node].z, psi0 = profile_.potential(z);
    const double excess = state_.u[node] - (state_.problem.split ? 0 : psi0);
    return face.normal.z * profile_.slope(z) -
           far_field_coefficient(state_.problem.spheres, middle, face.normal) * excess;
  }

  const State& state_;
  PlateProfile profile_;
  SourceTerm term_;
  std::vector<const Boundary*> boundary_;
};

}  // namespace

std::vector<Mirrors> find_mirrors(const par::Comm& comm, const Domain& domain, const Case& problem) {
  const auto& patches = domain.mesh->info.patches;
  const auto n = patches.size();
  std::vector<std::int64_t> common(n * n, 0);
  for (std::size_t i = 0; i < domain.point.size(); ++i) {
    if (!domain.nodes.is_owned(i) || domain.node_patches[i] == 0) continue;
    for (std::size_t p = 0; p < n; ++p)
      for (std::size_t q = 0; q < n; ++q)
        if (p != q && (domain.node_patches[i] >> p & 1U) != 0 && (domain.node_patches[i] >> q & 1U) != 0)
          ++common[p * n + q];
  }
  comm.sum_in_place(common);
  std::vector<Mirrors> result(n);
  std::vector<int> n_mirrors(3 * n, 0);
  for (std::size_t p = 0; p < n; ++p)
    for (std::size_t q = 0; q < n; ++q) {
      const auto* b = problem.find_boundary(patches[q].name);
      const int axis = domain.patches[q].axis;
      if (common[p * n + q] == 0 || b == nullptr || b->condition != Condition::symmetry || axis < 0) continue;
      if (domain.patches[p].axis == axis) continue;
      ++n_mirrors[3 * p + static_cast<std::size_t>(axis)];
    }
  for (std::size_t p = 0; p < n; ++p)
    for (int axis = 0; axis < 3; ++axis)
      if (n_mirrors[3 * p + static_cast<std::size_t>(axis)] == 1) {
        result[p].cut[axis] = true;
        result[p].factor *= 2;
      }
  return result;
}

std::vector<PatchResult> surface_results(const par::Comm& comm, const State& state) {
  const auto& patches = state.domain.mesh->info.patches;
  std::vector<FaceSums> sums(patches.size());
  const FaceTerms terms(state);
  for (const auto& face : state.domain.faces) terms.add(face, sums[static_cast<std::size_t>(face.patch)]);
  std::vector<PatchResult> results;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const auto& mirrors = state.mirrors[p];
    PatchResult result;
    result.name = patches[p].name;
    result.symmetry_factor = mirrors.factor;
    result.area = state.domain.patches[p].area;
    const double charge = par::reproducible_sums(comm, std::span(&sums[p].charge, 1))[0];
    result.charge = mirrors.factor * charge;
    result.charge_density = result.area > 0 ? charge / result.area : 0;
    result.surface = mirrors.complete(sums[p].raw.total(comm));
    result.surface_recovered = mirrors.complete(sums[p].recovered.total(comm));
    const auto reaction = mirrors.complete(sums[p].reaction.total(comm));
    const auto* b = state.problem.find_boundary(patches[p].name);
    if (b != nullptr && b->condition == Condition::potential) result.surface_reaction = reaction;
    results.push_back(result);
  }
  return results;
}

namespace {

/// 1 up to `inner`, 0 from `outer` on, a cubic between them.
std::vector<double> fall_off(const std::vector<double>& distance, double inner, double outer) {
  std::vector<double> result;
  result.reserve(distance.size());
  for (const double d : distance) {
    const double t = std::clamp((d - inner) / (outer - inner), 0.0, 1.0);
    result.push_back(1 - t * t * (3 - 2 * t));
  }
  return result;
}

}  // namespace

std::optional<CutOff> make_cut_off(const par::Comm& comm, const State& state, const Sphere& sphere, int patch) {
  const auto& domain = state.domain;
  std::uint64_t harmless = std::uint64_t{1} << static_cast<unsigned>(patch);
  for (std::size_t q = 0; q < domain.patches.size(); ++q) {
    const auto* b = state.problem.find_boundary(domain.mesh->info.patches[q].name);
    const int axis = domain.patches[q].axis;
    if (b != nullptr && b->condition == Condition::symmetry && axis >= 0 &&
        state.mirrors[static_cast<std::size_t>(patch)].cut[axis]) {
      const double away = axis == 0 ? sphere.center.x : axis == 1 ? sphere.center.y : sphere.center.z;
      // The mirror that cuts this sphere, not another of the same direction.
      double level = 0;
      for (const auto& face : domain.faces)
        if (face.patch == static_cast<int>(q)) {
          const auto point = domain.point[static_cast<std::size_t>(face.node[0])];
          level = std::abs((axis == 0 ? point.x : axis == 1 ? point.y : point.z) - away);
        }
      if (comm.max(level) < sphere.radius) harmless |= std::uint64_t{1} << q;
    }
  }
  double gap = HUGE_VAL;
  std::vector<double> distance(domain.point.size());
  for (std::size_t i = 0; i < distance.size(); ++i) {
    distance[i] = norm(domain.point[i] - sphere.center) - sphere.radius;
    if ((domain.node_patches[i] & ~harmless) != 0) gap = std::min(gap, distance[i]);
  }
  gap = comm.min(gap);
  const bool asked = state.problem.force.inner || state.problem.force.outer;
  if (!asked && gap < 1e-3 * sphere.radius) return std::nullopt;
  CutOff result;
  result.outer = state.problem.force.outer.value_or(std::min(4.0, 0.95 * gap));
  result.inner = state.problem.force.inner.value_or(0.5 * result.outer);
  if (!(result.outer <= gap) || !(result.inner < result.outer))
    throw Error(
        fmt::format("expected a cut-off function within the {:g} Debye lengths from sphere {} to the nearest "
                    "other boundary, found inner {:g} and outer {:g}",
                    gap, sphere.patch, result.inner, result.outer));
  result.chi = fall_off(distance, result.inner, result.outer);
  return result;
}

CutOff make_plate_cut_off(const par::Comm& comm, const State& state) {
  const auto& domain = state.domain;
  std::vector<double> height(domain.point.size());
  double gap = HUGE_VAL;
  for (const auto& sphere : state.problem.spheres)
    gap = std::min(gap, sphere.center.z - sphere.radius - state.problem.plate->position);
  double top = 0;
  for (std::size_t i = 0; i < height.size(); ++i) {
    height[i] = domain.point[i].z - state.problem.plate->position;
    top = std::max(top, height[i]);
  }
  CutOff result;
  result.outer = 0.95 * std::min(gap, comm.max(top));
  result.inner = 0.5 * result.outer;
  result.chi = fall_off(height, result.inner, result.outer);
  return result;
}

namespace {

/// Gradient of the cut-off function in a cell and what belongs to psi0 there; false where the function is constant.
struct CutOffCell {
  Vec3 slope;  ///< grad chi
  Vec3 base;   ///< grad psi0, mean of the corners
};
bool cut_off_cell(const State& state, std::span<const double> chi, std::size_t cell, const CellShape& shape,
                  CutOffCell& result) {
  const auto& nodes = state.domain.mesh->cell_to_node[cell];
  const double first = chi[static_cast<std::size_t>(nodes[0])];
  bool constant = true;
  result = {};
  for (std::size_t k = 0; k < 4; ++k) {
    const double here = chi[static_cast<std::size_t>(nodes[k])];
    constant = constant && here == first;
    result.slope = result.slope + here * shape.gradient[k];
  }
  if (constant) return false;
  if (state.problem.split) {
    const auto profile = state.problem.profile();
    for (const auto node : nodes)
      result.base.z += profile.slope(state.domain.point[static_cast<std::size_t>(node)].z) / 4;
  }
  return true;
}

double component(Vec3 v, int axis) { return axis == 0 ? v.x : axis == 1 ? v.y : v.z; }

}  // namespace

Vec3 volume_force(const par::Comm& comm, const State& state, std::span<const double> chi) {
  const auto& cells = state.domain.mesh->cell_to_node;
  const SourceTerm term(state.problem.linear);
  VectorSum sum;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto shape = state.domain.shape(c);
    CutOffCell at;
    if (!cut_off_cell(state, chi, c, shape, at)) continue;
    double pressure = 0;
    for (const auto node : cells[c]) {
      const auto i = static_cast<std::size_t>(node);
      pressure += term.pressure(state.u[i], state.conditions.psi0[i]) / 4;
    }
    const auto electric = stress(state.cell_gradient[c] + at.base, at.slope) - stress(at.base, at.slope);
    sum.add(-shape.volume * (electric - pressure * at.slope));
  }
  return sum.total(comm);
}

std::vector<double> volume_force_derivative(const par::Comm& comm, const State& state, std::span<const double> chi,
                                            int axis) {
  const auto& cells = state.domain.mesh->cell_to_node;
  const SourceTerm term(state.problem.linear);
  std::vector<double> result(state.domain.point.size(), 0);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto shape = state.domain.shape(c);
    CutOffCell at;
    if (!cut_off_cell(state, chi, c, shape, at)) continue;
    const auto gradient = state.cell_gradient[c] + at.base;
    const double through = dot(gradient, at.slope), along = component(at.slope, axis);
    for (std::size_t k = 0; k < 4; ++k) {
      const auto i = static_cast<std::size_t>(cells[c][k]);
      const double source = term.value(state.conditions.psi0[i] + state.u[i], 0);
      result[i] -= shape.volume * (component(shape.gradient[k], axis) * through +
                                   component(gradient, axis) * dot(shape.gradient[k], at.slope) -
                                   along * (dot(gradient, shape.gradient[k]) + source / 4));
    }
  }
  state.domain.nodes.sum_copies(comm, result);
  return result;
}

namespace {

/// The triangle of a mirror: gradients of its three corner functions within it.
std::array<Vec3, 3> triangle_gradients(const Domain& domain, const BoundaryFace& face) {
  std::array<Vec3, 3> p, result;
  for (std::size_t k = 0; k < 3; ++k) p[k] = domain.point[static_cast<std::size_t>(face.node[k])];
  for (std::size_t k = 0; k < 3; ++k)
    result[k] = (0.5 / face.area) * cross(face.normal, p[(k + 2) % 3] - p[(k + 1) % 3]);
  return result;
}

}  // namespace

double midplane_force(const par::Comm& comm, const State& state, int patch) {
  const auto excess = excess_of(state);
  const SourceTerm term(state.problem.linear);
  std::array<par::ExactSum, 1> sum;
  for (const auto& face : state.domain.faces) {
    if (face.patch != patch) continue;
    const auto gradients = triangle_gradients(state.domain, face);
    Vec3 gradient;
    for (std::size_t k = 0; k < 3; ++k)
      gradient = gradient + excess.u[static_cast<std::size_t>(face.node[k])] * gradients[k];
    double rest = 0;
    for (const auto& at : triangle_points) {
      double u = 0, psi0 = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        u += at.weight_of_corner[k] * excess.u[static_cast<std::size_t>(face.node[k])];
        psi0 += at.weight_of_corner[k] * excess.psi0[static_cast<std::size_t>(face.node[k])];
      }
      rest += at.weight * term.convex_rest(u, psi0);
    }
    sum[0].add(face.area * (0.5 * squared_norm(gradient) + rest));
  }
  return par::reproducible_sums(comm, sum)[0];
}

std::vector<double> midplane_derivative(const par::Comm& comm, const State& state, int patch) {
  const auto excess = excess_of(state);
  const SourceTerm term(state.problem.linear);
  std::vector<double> result(state.domain.point.size(), 0);
  for (const auto& face : state.domain.faces) {
    if (face.patch != patch) continue;
    const auto gradients = triangle_gradients(state.domain, face);
    Vec3 gradient;
    for (std::size_t k = 0; k < 3; ++k)
      gradient = gradient + excess.u[static_cast<std::size_t>(face.node[k])] * gradients[k];
    for (std::size_t k = 0; k < 3; ++k)
      result[static_cast<std::size_t>(face.node[k])] += face.area * dot(gradient, gradients[k]);
    for (const auto& at : triangle_points) {
      double u = 0, psi0 = 0;
      for (std::size_t k = 0; k < 3; ++k) {
        u += at.weight_of_corner[k] * excess.u[static_cast<std::size_t>(face.node[k])];
        psi0 += at.weight_of_corner[k] * excess.psi0[static_cast<std::size_t>(face.node[k])];
      }
      const double value = face.area * at.weight * term.value(u, psi0);
      for (std::size_t k = 0; k < 3; ++k)
        result[static_cast<std::size_t>(face.node[k])] += value * at.weight_of_corner[k];
    }
  }
  state.domain.nodes.sum_copies(comm, result);
  return result;
}

Energy energy_of(const par::Comm& comm, const State& state) {
  const auto excess = excess_of(state);
  const SourceTerm term(state.problem.linear);
  const auto profile = state.problem.profile();
  const auto& cells = state.domain.mesh->cell_to_node;
  std::array<par::ExactSum, 2> sums;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto shape = state.domain.shape(c);
    Vec3 total, rest, base;
    double pressure = 0, rest_pressure = 0;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto i = static_cast<std::size_t>(cells[c][k]);
      total = total + (excess.psi0[i] + excess.u[i]) * shape.gradient[k];
      rest = rest + excess.u[i] * shape.gradient[k];
      base.z += profile.slope(state.domain.point[i].z) / 4;
      pressure += term.pressure(excess.psi0[i] + excess.u[i], 0) / 4;
      rest_pressure += term.pressure(excess.u[i], excess.psi0[i]) / 4;
    }
    sums[0].add(shape.volume * (0.5 * squared_norm(total) + pressure));
    sums[1].add(shape.volume * (0.5 * squared_norm(rest) + dot(rest, base) + rest_pressure));
  }
  const auto totals = par::reproducible_sums(comm, sums);
  return {totals[0], totals[1]};
}

}  // namespace pamr::poisson_boltzmann
