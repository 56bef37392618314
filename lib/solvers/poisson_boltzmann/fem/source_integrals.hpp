// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "solvers/poisson_boltzmann/fem/petsc.hpp"
#include "solvers/poisson_boltzmann/fem/problem.hpp"

/// The source term of u by the points of the cells, in the form that the solver asks for.
namespace pamr::poisson_boltzmann {

/// Adds the integral of the source term of u times each shape function. Local.
void add_source(const Problem& problem, const std::vector<double>& u, std::vector<double>& to);

/// Adds the integral of the slope of the source term times two shape functions to a matrix that has their entries;
/// nodes with given u are left out. Collective.
void add_source_matrix(const Problem& problem, const std::vector<double>& u, Mat matrix);

/// Adds the product of that matrix with w, as if no node were fixed. Local.
void add_source_product(const Problem& problem, const std::vector<double>& u, std::span<const double> w,
                        std::vector<double>& to);

}  // namespace pamr::poisson_boltzmann
