// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "solvers/poisson_boltzmann/fem/fem_domain.hpp"

namespace pamr::poisson_boltzmann {

/// Conditions and sources at the nodes, for the unknown u = psi - psi0 (psi0 = 0 unless the case is split). All arrays
/// have an entry for each local node; copies on several ranks hold the same bits.
struct Conditions {
  std::vector<double> psi0;         ///< the part that is split off
  std::vector<std::uint8_t> fixed;  ///< 1 where u is given
  std::vector<double> value;        ///< u there
  std::vector<int> deciding_patch;  ///< patch that gives u there, -1 elsewhere
  std::vector<double> robin;        ///< alpha times the lumped area; 0 of second order, where the matrix has it
  std::vector<double> load;         ///< given charges, what belongs to psi0, sources; lumped, of second order integrals
  std::vector<double> fixed_area;   ///< a third of the faces of fixed patches around the node; 0 of second order
  /// Nodes where patches meet whose given potentials differ; the first such pair of patches by number.
  std::int64_t n_contradictions = 0;
  std::vector<std::int64_t> contradictions_on;  ///< how many of these nodes lie on each patch of the mesh
};

/// psi* = 2 sin x cos y exp(-z), for tests.
double manufactured_potential(geometry::Vec3 point);
geometry::Vec3 manufactured_gradient(geometry::Vec3 point);

/// Coefficient of the far-field condition at a point of the outer boundary: the decay of the potential of the spheres
/// of a case, each exp(-d)/d alone, in the direction of `normal`; 1 where there is no sphere; not negative.
double far_field_coefficient(const std::vector<Sphere>& spheres, geometry::Vec3 point, geometry::Vec3 normal);

/// dpsi/dn out of the liquid that a patch gives whose potential is free, but for what depends on u at the far field and
/// on walls with sites.
double given_flux(const Case& input, const PlateProfile& profile, const Boundary& boundary,
                  const PlacedFacePoint& point);

/// Works them out. Where patches with given u meet, one with a given potential goes before one with another condition,
/// and then the first patch of the mesh. Collective: a few exchanges, one reduction. Pre: `domain` was made for the
/// case.
Conditions make_conditions(const par::Comm& comm, const Domain& domain, const Case& problem);

}  // namespace pamr::poisson_boltzmann
