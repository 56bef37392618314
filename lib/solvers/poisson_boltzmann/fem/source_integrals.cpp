// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/source_integrals.hpp"

#include "solvers/poisson_boltzmann/fem/elements.hpp"

namespace pamr::poisson_boltzmann {

namespace {

/// Calls `use(point, u, psi0)` for the points of a cell.
template <class Cell, class Use>
void at_sources(const Problem& problem, const Cell& cell, std::span<const double> u, const Use& use) {
  const auto value = at_nodes(cell.nodes, u);
  cell.at_points([&](const auto& point) {
    use(point, interpolated(point.value, value), problem.split_potential(point.position.z));
  });
}

template <class Element>
void add_matrix(const Element& element, const Problem& problem, std::span<const double> u, Mat matrix) {
  constexpr auto n = Element::n_nodes;
  for (std::size_t c = 0; c < element.cells().size(); ++c) {
    const auto cell = element.points(c);
    std::array<double, n * n> block{};
    at_sources(problem, cell, u, [&](const auto& point, double value, double psi0) {
      const double amount = point.weight * problem.term.slope(value, psi0);
      for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j) block[n * i + j] += amount * point.value[i] * point.value[j];
    });
    std::array<PetscInt, n> row{};
    for (std::size_t k = 0; k < n; ++k) {
      const auto node = at(cell.nodes[k]);
      // PETSc leaves negative rows out.
      row[k] = problem.conditions.fixed[node] != 0 ? -1 : problem.domain.nodes.equation()[node];
    }
    constexpr auto size = static_cast<PetscInt>(n);
    require(MatSetValues(matrix, size, row.data(), size, row.data(), block.data(), ADD_VALUES));
  }
}

}  // namespace

void add_source(const Problem& problem, const std::vector<double>& u, std::vector<double>& to) {
  with_element(problem.domain, [&](const auto& element) {
    for (std::size_t c = 0; c < element.cells().size(); ++c) {
      const auto cell = element.points(c);
      at_sources(problem, cell, u, [&](const auto& point, double value, double psi0) {
        const double amount = point.weight * problem.term.value(value, psi0);
        for (std::size_t k = 0; k < cell.nodes.size(); ++k) to[at(cell.nodes[k])] += amount * point.value[k];
      });
    }
  });
}

void add_source_matrix(const Problem& problem, const std::vector<double>& u, Mat matrix) {
  with_element(problem.domain, [&](const auto& element) { add_matrix(element, problem, u, matrix); });
  require(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  require(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
}

void add_source_product(const Problem& problem, const std::vector<double>& u, std::span<const double> w,
                        std::vector<double>& to) {
  with_element(problem.domain, [&](const auto& element) {
    for (std::size_t c = 0; c < element.cells().size(); ++c) {
      const auto cell = element.points(c);
      const auto of_w = at_nodes(cell.nodes, w);
      at_sources(problem, cell, u, [&](const auto& point, double value, double psi0) {
        const double amount = point.weight * problem.term.slope(value, psi0) * interpolated(point.value, of_w);
        for (std::size_t k = 0; k < cell.nodes.size(); ++k) to[at(cell.nodes[k])] += amount * point.value[k];
      });
    }
  });
}

}  // namespace pamr::poisson_boltzmann
