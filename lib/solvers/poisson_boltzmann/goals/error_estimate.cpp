// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/error_estimate.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "pamr/base/index.hpp"
#include "pamr/mark/recovery.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "solvers/poisson_boltzmann/fem/elements.hpp"
#include "solvers/poisson_boltzmann/goals/goal_rest.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;

namespace {

double longest_edge(const geometry::TetPoints& p) {
  double longest = 0;
  for (const auto& [a, b] : mesh::tet::edge_to_corner) longest = std::max(longest, squared_norm(p[at(a)] - p[at(b)]));
  return std::sqrt(longest);
}

}  // namespace

std::vector<Vec3> cell_gradients(const Domain& domain, std::span<const double> value) {
  const auto& cells = domain.mesh->cell_to_node;
  std::vector<Vec3> result(cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) result[c] = LinearElement::Cell(domain, c).field(value).slope;
  return result;
}

std::vector<Vec3> recover(const par::Comm& comm, const Domain& domain, std::span<const Vec3> cell_gradient,
                          Recovery recovery) {
  const auto& cells = domain.mesh->cell_to_node;
  std::vector<double> weight(cells.size(), 1);
  if (recovery == Recovery::volume_weighted)
    for (std::size_t c = 0; c < cells.size(); ++c) weight[c] = geometry::volume(domain.points(c));
  auto result = mark::nodal_means<Vec3>(par::Exchange(comm, domain.nodes.shared()), domain.point.size(), cells, weight,
                                        cell_gradient);
  if (!domain.sides) return result;
  const auto n_nodes = domain.mesh->n_nodes();
  const auto of_sides =
      mark::nodal_means<Vec3>(par::Exchange(comm, domain.sides->shared), domain.sides->n_sides, [&](const auto& add) {
        for (std::size_t c = 0; c < cells.size(); ++c)
          for (const auto node : domain.recovery_nodes(c))
            if (node >= n_nodes) add(node - n_nodes, weight[c], cell_gradient[c]);
      });
  result.insert(result.end(), of_sides.begin(), of_sides.end());
  return result;
}

std::vector<Vec3> recover(const par::Comm& comm, const Domain& domain, std::span<const double> u, Recovery recovery) {
  const QuadraticElement element(domain);
  return mark::nodal_means<Vec3>(par::Exchange(comm, domain.nodes.shared()), domain.point.size(), [&](const auto& add) {
    for (std::size_t c = 0; c < element.cells().size(); ++c) {
      const auto cell = element.cell(c);
      const auto field = cell.field(u);
      const double weight = recovery == Recovery::plain ? 1 : geometry::volume(domain.points(c));
      cell.at_nodes([&](const auto& point) { add(cell.nodes[point.index], weight, field.gradient(point)); });
    }
  });
}

namespace {

std::array<Vec3, 4> differences(const mesh::CellNodes& nodes, std::span<const Vec3> recovered, Vec3 cell_gradient) {
  std::array<Vec3, 4> result;
  for (std::size_t k = 0; k < 4; ++k) result[k] = recovered[at(nodes[k])] - cell_gradient;
  return result;
}

/// Integral over a cell of the squared difference of the recovered gradient and that of the cell.
double squared_error(const mesh::CellNodes& nodes, double volume, Vec3 cell_gradient, std::span<const Vec3> recovered) {
  const auto difference = differences(nodes, recovered, cell_gradient);
  return mark::integral_of_product(volume, difference, difference);
}

}  // namespace

std::vector<double> squared_errors(const Domain& domain, std::span<const Vec3> cell_gradient,
                                   std::span<const Vec3> recovered) {
  const auto& cells = domain.mesh->cell_to_node;
  std::vector<double> result(cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c)
    result[c] =
        squared_error(domain.recovery_nodes(c), geometry::volume(domain.points(c)), cell_gradient[c], recovered);
  return result;
}

Estimate estimate_error(const par::Comm& comm, const Problem& problem, std::span<const double> u,
                        std::span<const Vec3> cell_gradient, std::span<const Vec3> recovered) {
  const auto& domain = problem.domain;
  const auto& psi0 = problem.conditions.psi0;
  const auto& cells = domain.mesh->cell_to_node;
  Estimate result;
  result.squared.resize(cells.size());
  result.residual_squared.resize(cells.size());
  std::vector<double> squared_source(u.size());  // a node has some 24 cells, and a sinh costs more than all of one cell
  for (std::size_t i = 0; i < u.size(); ++i) {
    const double value = problem.term.value(u[i], psi0[i]);
    squared_source[i] = value * value;
  }
  std::array<par::ExactSum, 3> sums;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto p = domain.points(c);
    const double volume = geometry::volume(p), h = longest_edge(p) / std::numbers::pi;
    double source = 0;
    for (const auto node : cells[c]) source += squared_source[at(node)] / 4;
    result.squared[c] = squared_error(domain.recovery_nodes(c), volume, cell_gradient[c], recovered);
    result.residual_squared[c] = h * h * volume * source;
    sums[0].add(result.squared[c]);
    sums[1].add(result.residual_squared[c]);
    sums[2].add(volume * squared_norm(cell_gradient[c]));
  }
  const auto totals = par::reproducible_sums(comm, sums);
  result.total_squared = totals[0];
  result.residual_total_squared = totals[1];
  result.norm_squared = totals[2];
  return result;
}

namespace {

/// What taking values at the nodes adds to an integral, and the integral of the sizes of these values.
struct Lumped {
  double excess = 0, size = 0;

  /// A bound for the error that the excess leaves in a goal after its correction, which contains the excess to first
  /// order. Each further order is taken to be excess over size times the order before. The bound is at most the excess
  /// itself, which it reaches where the integrand is 0 at all nodes.
  double further() const {
    const double most = std::abs(excess);
    return most < size ? further_orders(most / size) * most : most;
  }
};

/// What a mean of the corners of a cell makes of an integral of `value(u, psi0, weights of the corners)`, less the
/// integral by Gauss points. psi0 is the profile at the point: between its values at the nodes a straight line is far
/// above it near a plate of high potential.
template <class Value>
Lumped nodal_excess(const Problem& problem, std::size_t number, std::span<const double> u, const Value& value) {
  const LinearElement::Points cell(problem.domain, number);
  const auto of_u = at_nodes(cell.nodes, u), psi0 = at_nodes<double>(cell.nodes, problem.conditions.psi0);
  Lumped result;
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<double, 4> corner{};
    corner[k] = 1;
    const double there = cell.volume / 4 * value(of_u[k], psi0[k], corner);
    result.excess += there;
    result.size += std::abs(there);
  }
  cell.at_points([&](const auto& point) {
    result.excess -=
        point.weight * value(interpolated(point.value, of_u), problem.split_potential(point.position.z), point.value);
  });
  return result;
}

/// What lumping at the nodes makes of the charges of sites, weighted with the dual solution, less the integral over the
/// face; less by 1 is the dual solution where the goal is that charge. Calls `use(cell, Lumped)` for each such face.
template <class Use>
void at_lumped_sites(const Problem& problem, const GoalInput& in, const Use& use) {
  const auto& domain = problem.domain;
  for (std::size_t f = 0; f < domain.faces.size(); ++f) {
    const auto patch = domain.faces[f].patch;
    const auto& b = problem.boundary_of(domain.faces[f]);
    if (b.condition != Condition::regulated) continue;
    const double counted = (in.counted >> static_cast<unsigned>(patch) & 1U) != 0 ? 1 : 0;
    const LinearElement::Face face(domain, f);
    const auto u = face.values(in.u), w = face.values(in.w);
    Lumped lumped;
    const auto value = [&](const auto& point, double psi0) {
      return point.area * b.site.value(psi0 + interpolated(point.value, u)) * (interpolated(point.value, w) - counted);
    };
    face.at_wall_points([&](const auto& point) {
      const double there = value(point, face.split_potential(problem, point));
      lumped.excess += there;
      lumped.size += std::abs(there);
    });
    face.at_points(
        [&](const auto& point) { lumped.excess -= value(point, problem.split_potential(point.position.z)); });
    use(at(domain.faces[f].cell), lumped);
  }
}

/// Collective.
void set_sums(const par::Comm& comm, std::array<par::ExactSum, 3>& sums, GoalError& result) {
  const auto totals = par::reproducible_sums(comm, sums);
  result.correction = totals[0];
  result.recovered = totals[1];
  result.lumped = totals[2];
}

}  // namespace

GoalError goal_error(const par::Comm& comm, const Problem& problem, const GoalInput& in) {
  const auto& domain = problem.domain;
  const bool is_nodal = problem.input.solver.quadrature == Quadrature::nodal;
  const auto& cells = domain.mesh->cell_to_node;
  GoalError result;
  result.share.resize(cells.size());
  std::array<par::ExactSum, 3> sums;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const double volume = geometry::volume(domain.points(c));
    const auto error_u = differences(domain.recovery_nodes(c), in.recovered_u, in.gradient_u[c]);
    std::array<Vec3, 4> error_w;
    for (std::size_t k = 0; k < 4; ++k)
      error_w[k] = in.dual.recovered_in(c, k, at(domain.recovery_nodes(c)[k])) - in.dual.of_cells[c];
    double correction = mark::integral_of_product(volume, error_u, error_w);
    result.share[c] = std::sqrt(mark::integral_of_product(volume, error_u, error_u) *
                                mark::integral_of_product(volume, error_w, error_w));
    sums[1].add(result.share[c]);
    if (is_nodal) {
      const auto lumped = nodal_excess(problem, c, in.u, [&](double u, double psi0, const auto& weight_of_corner) {
        double w = 0;
        for (std::size_t k = 0; k < 4; ++k) w += weight_of_corner[k] * in.w[at(cells[c][k])];
        return problem.term.value(u, psi0) * w;
      });
      correction += lumped.excess;
      result.share[c] += std::abs(lumped.excess);
      sums[2].add(lumped.further());
    }
    sums[0].add(correction);
  }
  if (problem.input.has_regulated())
    at_lumped_sites(problem, in, [&](std::size_t cell, const Lumped& lumped) {
      sums[0].add(-lumped.excess);
      result.share[cell] += std::abs(lumped.excess);
      sums[2].add(lumped.further());
    });
  set_sums(comm, sums, result);
  return result;
}

GoalError energy_error(const par::Comm& comm, const Problem& problem, std::span<const double> u,
                       std::span<const double> squared) {
  GoalError result;
  result.share.resize(squared.size());
  std::array<par::ExactSum, 3> sums;
  for (std::size_t c = 0; c < squared.size(); ++c) {
    const auto lumped = nodal_excess(
        problem, c, u, [&](double value, double psi0, const auto&) { return problem.term.pressure(value, psi0); });
    result.share[c] = squared[c] / 2 + std::abs(lumped.excess);
    sums[0].add(-squared[c] / 2 - lumped.excess);
    sums[1].add(squared[c] / 2);
    sums[2].add(lumped.further());
  }
  set_sums(comm, sums, result);
  return result;
}

}  // namespace pamr::poisson_boltzmann
