// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "solvers/poisson_boltzmann/fem/petsc.hpp"
#include "solvers/poisson_boltzmann/fem/problem.hpp"

/// The terms of the equation on isoparametric cells of second order. Every integral is taken by points, none is lumped:
/// lumped masses of the corners would be negative.
namespace pamr::poisson_boltzmann {

/// Integral of grad v grad w, and of alpha v w over the far field, for all nodes. Collective.
Matrix assemble_quadratic_stiffness(const par::Comm& comm, const Problem& problem);

/// Adds the integral of the source term of u times each shape function. Local.
void add_quadratic_source(const Problem& problem, const std::vector<double>& u, std::vector<double>& to);

/// Adds the integral of the slope of the source term times two shape functions to a matrix that has their entries;
/// nodes with given u are left out. Collective.
void add_quadratic_source_matrix(const Problem& problem, const std::vector<double>& u, Mat matrix);

/// Adds the product of that matrix with w, as if no node were fixed. Local.
void add_quadratic_source_product(const Problem& problem, const std::vector<double>& u, std::span<const double> w,
                                  std::vector<double>& to);

/// dpsi/dn out of the liquid that a patch gives whose potential is free, but for what depends on u at the far field and
/// on walls with sites.
double given_flux(const Case& input, const PlateProfile& profile, const Boundary& boundary,
                  const PlacedFacePoint& placed);

/// Loads of given charges, the far field, the split-off profile and sources at the nodes, of this rank's cells. Local.
std::vector<double> quadratic_load(const Domain& domain, const Case& input);

}  // namespace pamr::poisson_boltzmann
