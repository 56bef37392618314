// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/volume_force.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/wall_stress.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

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
  const auto& domain = state.problem.domain;
  const auto& input = state.problem.input;
  std::uint64_t harmless = std::uint64_t{1} << static_cast<unsigned>(patch);
  for (std::size_t q = 0; q < domain.patches.size(); ++q) {
    const auto* b = input.find_boundary(domain.mesh->info.patches[q].name);
    const int axis = domain.patches[q].axis;
    if (b != nullptr && b->condition == Condition::symmetry && axis >= 0 && state.mirrors[at(patch)].cut[axis]) {
      // The mirror that cuts this sphere, not another of the same direction.
      double level = 0;
      for (const auto& face : domain.faces)
        if (face.patch == static_cast<int>(q))
          level = std::abs(domain.point[at(face.node[0])][at(axis)] - sphere.center[at(axis)]);
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
  const bool asked = input.force.inner || input.force.outer;
  if (!asked && gap < 1e-3 * sphere.radius) return std::nullopt;
  CutOff result;
  result.outer = input.force.outer.value_or(std::min(4.0, 0.95 * gap));
  result.inner = input.force.inner.value_or(0.5 * result.outer);
  if (!(result.outer <= gap) || !(result.inner < result.outer))
    throw Error(
        fmt::format("expected a cut-off function within the {:g} Debye lengths from sphere {} to the nearest "
                    "other boundary, found inner {:g} and outer {:g}",
                    gap, sphere.patch, result.inner, result.outer));
  result.chi = fall_off(distance, result.inner, result.outer);
  return result;
}

CutOff make_plate_cut_off(const par::Comm& comm, const State& state) {
  const auto& domain = state.problem.domain;
  const auto& input = state.problem.input;
  std::vector<double> height(domain.point.size());
  double gap = HUGE_VAL;
  for (const auto& sphere : input.spheres) gap = std::min(gap, sphere.center.z - sphere.radius - input.plate->position);
  double top = 0;
  for (std::size_t i = 0; i < height.size(); ++i) {
    height[i] = domain.point[i].z - input.plate->position;
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
bool cut_off_cell(const Problem& problem, std::span<const double> chi, std::size_t cell, const CellShape& shape,
                  CutOffCell& result) {
  const auto& nodes = problem.domain.mesh->cell_to_node[cell];
  const double first = chi[at(nodes[0])];
  bool constant = true;
  result = {};
  for (std::size_t k = 0; k < 4; ++k) {
    const double here = chi[at(nodes[k])];
    constant = constant && here == first;
    result.slope += here * shape.gradient[k];
  }
  if (constant) return false;
  for (const auto node : nodes) result.base.z += problem.split_slope(problem.domain.point[at(node)].z) / 4;
  return true;
}

}  // namespace

Vec3 volume_force(const par::Comm& comm, const State& state, std::span<const double> chi) {
  const auto& problem = state.problem;
  const auto& cells = problem.domain.mesh->cell_to_node;
  VectorSum sum;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto shape = problem.domain.shape(c);
    CutOffCell cut;
    if (!cut_off_cell(problem, chi, c, shape, cut)) continue;
    double pressure = 0;
    for (const auto node : cells[c]) {
      const auto i = at(node);
      pressure += problem.term.pressure(state.u[i], problem.conditions.psi0[i]) / 4;
    }
    const auto electric = stress(state.cell_gradient[c] + cut.base, cut.slope) - stress(cut.base, cut.slope);
    sum.add(-shape.volume * (electric - pressure * cut.slope));
  }
  return sum.total(comm);
}

std::vector<double> volume_force_derivative(const par::Comm& comm, const State& state, std::span<const double> chi,
                                            int axis) {
  const auto& problem = state.problem;
  const auto& cells = problem.domain.mesh->cell_to_node;
  std::vector<double> result(problem.domain.point.size(), 0);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto shape = problem.domain.shape(c);
    CutOffCell cut;
    if (!cut_off_cell(problem, chi, c, shape, cut)) continue;
    const auto gradient = state.cell_gradient[c] + cut.base;
    const double through = dot(gradient, cut.slope), along = cut.slope[at(axis)];
    for (std::size_t k = 0; k < 4; ++k) {
      const auto i = at(cells[c][k]);
      const double source = problem.term.value(problem.conditions.psi0[i] + state.u[i], 0);
      result[i] -= shape.volume *
                   (shape.gradient[k][at(axis)] * through + gradient[at(axis)] * dot(shape.gradient[k], cut.slope) -
                    along * (dot(gradient, shape.gradient[k]) + source / 4));
    }
  }
  problem.domain.nodes.sum_copies(comm, result);
  return result;
}

}  // namespace pamr::poisson_boltzmann
