// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>
#include <vector>

#include "solvers/poisson_boltzmann/fem/elements.hpp"
#include "solvers/poisson_boltzmann/fem/petsc.hpp"

/// The terms that walls with sites, whose charge follows from the potential, add to the equation. They are lumped at
/// the nodes of flat faces, as given charges are, and taken by points of curved ones.
namespace pamr::poisson_boltzmann {

/// A point of such a wall.
struct SitePoint {
  std::size_t face = 0;            ///< of `Domain::faces`
  std::span<const LocalId> nodes;  ///< of the face, three or six
  std::span<const double> value;   ///< of their functions at the point
  double area = 0;                 ///< that the point stands for, Debye lengths squared
  double psi = 0;
  const SiteCharge* site = nullptr;
  std::size_t index = 0;  ///< of the points of the face, of second order in `face_points()`

  /// The value at the point of what has these values at all nodes.
  double value_of(std::span<const double> at_nodes) const {
    double sum = 0;
    for (std::size_t k = 0; k < nodes.size(); ++k) sum += value[k] * at_nodes[at(nodes[k])];
    return sum;
  }
  /// Adds an amount to the nodes, by their functions.
  void add(double amount, std::vector<double>& to) const {
    for (std::size_t k = 0; k < nodes.size(); ++k) to[at(nodes[k])] += amount * value[k];
  }
};

/// Calls `use(const SitePoint&)` for the points of all faces with sites on this rank. `u`: n_nodes. Local.
template <class Use>
void at_site_points(const Problem& problem, std::span<const double> u, const Use& use) {
  if (!problem.input.has_regulated()) return;
  const auto& domain = problem.domain;
  with_element(domain, [&](const auto& element) {
    for (std::size_t f = 0; f < domain.faces.size(); ++f) {
      const auto& b = problem.boundary_of(domain.faces[f]);
      if (b.condition != Condition::regulated) continue;
      const auto face = element.face(f);
      face.at_wall_points([&](const auto& on_face) {
        SitePoint point{f, face.nodes, on_face.value, on_face.area, 0, &b.site, on_face.index};
        point.psi = face.split_potential(problem, on_face) + point.value_of(u);
        use(point);
      });
    }
  });
}

/// Adds the integral of the charge density times each shape function, times `factor`. Local.
void add_site_charge(const Problem& problem, std::span<const double> u, double factor, std::vector<double>& to);

/// Adds minus the slope of that density times w, likewise: what the linearized equation has of w. Local.
void add_site_slope(const Problem& problem, std::span<const double> u, std::span<const double> w,
                    std::vector<double>& to);

/// Adds the matrix of that product to one that has its entries; nodes with given u are left out.
/// Collective, and only where there are such walls.
void add_site_matrix(const Problem& problem, std::span<const double> u, Mat matrix);

}  // namespace pamr::poisson_boltzmann
