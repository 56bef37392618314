// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/volume_force.hpp"

#include <array>
#include <cmath>

#include "pamr/base/index.hpp"
#include "solvers/poisson_boltzmann/fem/quadrature.hpp"
#include "solvers/poisson_boltzmann/goals/quadratic_analysis.hpp"
#include "solvers/poisson_boltzmann/goals/quadratic_goals.hpp"
#include "solvers/poisson_boltzmann/goals/wall_stress.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

Vec3 Component::at(Vec3 point) const {
  Vec3 unit;
  unit[pamr::at(axis)] = 1;
  return is_torque ? cross(unit, point - center) : unit;
}

namespace {

/// A cell in which the cut-off function varies.
struct CutOffCell {
  Vec3 slope;   ///< grad chi
  Vec3 middle;  ///< centroid
  Vec3 base;    ///< grad psi0, mean of the Gauss points: bounded even where the plate's own slope is not
  std::array<double, 4> u{}, psi0{};  ///< at the Gauss points; psi0 is exact there
};

bool is_constant(std::span<const double> chi, const mesh::CellNodes& nodes) {
  const double first = chi[at(nodes[0])];
  return chi[at(nodes[1])] == first && chi[at(nodes[2])] == first && chi[at(nodes[3])] == first;
}

CutOffCell cut_off_cell(const State& state, std::span<const double> chi, std::size_t cell, const CellShape& shape) {
  const auto& problem = state.problem;
  const auto& nodes = problem.domain.mesh->cell_to_node[cell];
  CutOffCell result;
  for (std::size_t k = 0; k < 4; ++k) {
    const double here = chi[at(nodes[k])];
    result.slope += here * shape.gradient[k];
    result.middle += 0.25 * problem.domain.point[at(nodes[k])];
  }
  for (std::size_t g = 0; g < 4; ++g) {
    for (std::size_t k = 0; k < 4; ++k) result.u[g] += gauss_points[g].weight_of_corner[k] * state.u[at(nodes[k])];
    if (!problem.input.split) continue;
    double z = 0;
    for (std::size_t k = 0; k < 4; ++k) z += gauss_points[g].weight_of_corner[k] * problem.domain.point[at(nodes[k])].z;
    result.psi0[g] = problem.split_potential(z);
    result.base.z += gauss_points[g].weight * problem.split_slope(z);
  }
  return result;
}

/// Mean of the pressure at the Gauss points of a cell where nothing is split off and the equation is not linear. An
/// exponential of a sum is a product of exponentials, which the nodes have once for all their cells.
class GaussPressure {
 public:
  explicit GaussPressure(std::span<const double> u) : shared_(u.size()), own_(u.size()) {
    constexpr double near = gauss_points[0].weight_of_corner[0], far = gauss_points[0].weight_of_corner[1];
    for (std::size_t i = 0; i < u.size(); ++i) {
      shared_[i] = std::exp(far * u[i] / 2);
      own_[i] = std::exp((near - far) * u[i] / 2);
    }
  }

  double mean(const mesh::CellNodes& nodes) const {
    double shared = 1, squares = 0;
    for (const auto node : nodes) shared *= shared_[at(node)];
    for (const auto node : nodes) {
      const double exponential = shared * own_[at(node)];       // of half of the potential
      const double twice_sinh = exponential - 1 / exponential;  // cosh u - 1 = 2 sinh(u/2)^2
      squares += twice_sinh * twice_sinh;
    }
    return squares / 8;
  }

 private:
  std::vector<double> shared_, own_;
};

/// What the walls give that meet the body and are no mirrors.
void add_walls(const State& state, std::span<const double> chi, std::uint64_t open_walls, Vec3 center, VectorSum& force,
               VectorSum& torque) {
  const auto& problem = state.problem;
  if (open_walls == 0) return;
  for (const auto& face : problem.domain.faces) {
    if ((open_walls >> static_cast<unsigned>(face.patch) & 1U) == 0) continue;
    double share = 0, pressure = 0;
    Vec3 middle;
    for (const auto node : face.node) {
      const auto i = at(node);
      share += chi[i] / 3;
      pressure += problem.term.pressure(state.u[i], problem.conditions.psi0[i]) * chi[i] / 3;
      middle += (1.0 / 3) * problem.domain.point[i];
    }
    if (share == 0) continue;
    const Vec3 base{0, 0, problem.split_slope(face.node)};
    const auto part = face.area * (share * added_stress(state.cell_gradient[at(face.cell)], base, face.normal) -
                                   pressure * face.normal);
    force.add(part);
    torque.add(cross(middle - center, part));
  }
}

}  // namespace

VolumeForm volume_form(const par::Comm& comm, const State& state, std::span<const double> chi, std::uint64_t open_walls,
                       Vec3 center) {
  const auto& problem = state.problem;
  if (problem.domain.quadratic) return quadratic_volume_form(comm, state, chi, open_walls, center);
  const auto& cells = problem.domain.mesh->cell_to_node;
  VectorSum force, torque, walls;
  const bool has_products = !problem.input.split && problem.term.is_sinh();
  const GaussPressure products(has_products ? state.u : std::span<const double>());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (is_constant(chi, cells[c])) continue;
    const auto shape = problem.domain.shape(c);
    const auto cut = cut_off_cell(state, chi, c, shape);
    double pressure = has_products ? products.mean(cells[c]) : 0;
    for (std::size_t g = 0; g < 4 && !has_products; ++g)
      pressure += gauss_points[g].weight * problem.term.pressure(cut.u[g], cut.psi0[g]);
    const auto electric = added_stress(state.cell_gradient[c], cut.base, cut.slope);
    const auto part = -shape.volume * (electric - pressure * cut.slope);
    force.add(part);
    torque.add(cross(cut.middle - center, part));
  }
  add_walls(state, chi, open_walls, center, walls, torque);
  VolumeForm result;
  result.through_walls = walls.total(comm);
  result.force = force.total(comm) + result.through_walls;
  result.torque = torque.total(comm);
  return result;
}

std::vector<double> volume_form_derivative(const par::Comm& comm, const State& state, std::span<const double> chi,
                                           std::uint64_t open_walls, const Component& component) {
  const auto& problem = state.problem;
  if (problem.domain.quadratic) return quadratic_volume_form_derivative(comm, state, chi, open_walls, component);
  const auto& cells = problem.domain.mesh->cell_to_node;
  std::vector<double> result(problem.domain.point.size(), 0);
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (is_constant(chi, cells[c])) continue;
    const auto shape = problem.domain.shape(c);
    const auto cut = cut_off_cell(state, chi, c, shape);
    const auto gradient = state.cell_gradient[c] + cut.base, direction = component.at(cut.middle);
    const double through = dot(gradient, cut.slope), along = dot(cut.slope, direction), here = dot(gradient, direction);
    std::array<double, 4> source{};  // mean of the slope of the pressure times each corner function
    for (std::size_t g = 0; g < 4; ++g) {
      const double slope = gauss_points[g].weight * problem.term.pressure_slope(cut.u[g], cut.psi0[g]);
      for (std::size_t k = 0; k < 4; ++k) source[k] += slope * gauss_points[g].weight_of_corner[k];
    }
    for (std::size_t k = 0; k < 4; ++k)
      result[at(cells[c][k])] -=
          shape.volume * (dot(shape.gradient[k], direction) * through + here * dot(shape.gradient[k], cut.slope) -
                          along * (dot(gradient, shape.gradient[k]) + source[k]));
  }
  problem.domain.nodes.sum_copies(comm, result);
  return result;
}

double volume_form_remainder(const par::Comm& comm, const State& state, std::span<const double> chi,
                             const Component& component) {
  const auto& problem = state.problem;
  const auto& cells = problem.domain.mesh->cell_to_node;
  std::array<par::ExactSum, 1> sum;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (is_constant(chi, cells[c])) continue;
    const auto shape = problem.domain.shape(c);
    const auto cut = cut_off_cell(state, chi, c, shape);
    const auto direction = component.at(cut.middle);
    const auto stress_of = [&](Vec3 error) {
      return dot(error, direction) * dot(error, cut.slope) - 0.5 * squared_norm(error) * dot(cut.slope, direction);
    };
    // Integral of a square of a linear function over a cell, by its corners: V/20 (sum of squares + square of the sum).
    Vec3 total;
    double squares = 0;
    for (const auto node : cells[c]) {
      const auto error = state.recovered[at(node)] - state.cell_gradient[c];
      total += error;
      squares += stress_of(error);
    }
    sum[0].add(-shape.volume / 20 * (squares + stress_of(total)));
  }
  return par::reproducible_sums(comm, sum)[0];
}

}  // namespace pamr::poisson_boltzmann
