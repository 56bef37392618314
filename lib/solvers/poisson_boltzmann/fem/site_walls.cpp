// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/site_walls.hpp"

namespace pamr::poisson_boltzmann {

void add_site_charge(const Problem& problem, std::span<const double> u, double factor, std::vector<double>& to) {
  at_site_points(problem, u,
                 [&](const SitePoint& point) { point.add(factor * point.area * point.site->value(point.psi), to); });
}

void add_site_slope(const Problem& problem, std::span<const double> u, std::span<const double> w,
                    std::vector<double>& to) {
  at_site_points(problem, u, [&](const SitePoint& point) {
    point.add(-point.area * point.site->slope(point.psi) * point.value_of(w), to);
  });
}

void add_site_matrix(const Problem& problem, std::span<const double> u, Mat matrix) {
  if (!problem.input.has_regulated()) return;
  std::array<PetscInt, 6> row{};
  std::array<double, 36> block{};
  at_site_points(problem, u, [&](const SitePoint& point) {
    const auto n = point.nodes.size();
    const double amount = -point.area * point.site->slope(point.psi);
    for (std::size_t i = 0; i < n; ++i) {
      const auto node = at(point.nodes[i]);
      row[i] = problem.conditions.fixed[node] != 0 ? -1 : problem.domain.nodes.equation()[node];
      for (std::size_t j = 0; j < n; ++j) block[n * i + j] = amount * point.value[i] * point.value[j];
    }
    const auto size = static_cast<PetscInt>(n);
    require(MatSetValues(matrix, size, row.data(), size, row.data(), block.data(), ADD_VALUES));
  });
  require(MatAssemblyBegin(matrix, MAT_FINAL_ASSEMBLY));
  require(MatAssemblyEnd(matrix, MAT_FINAL_ASSEMBLY));
}

}  // namespace pamr::poisson_boltzmann
