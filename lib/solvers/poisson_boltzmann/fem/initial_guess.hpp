// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "solvers/poisson_boltzmann/fem/conditions.hpp"

namespace pamr::poisson_boltzmann {

/// u at the local nodes from a potential on the nodes of the mesh, as a coarser level left it: an initial guess for
/// `System::solve`. Collective: one reduction. Throws `Error` on every rank when the mesh has no such field of one real
/// component, or values beyond `largest_argument`; `where` names the mesh file.
std::vector<double> initial_guess(const par::Comm& comm, const mesh::DistMesh& mesh, const Conditions& conditions,
                                  const std::string& field, const std::string& where);

}  // namespace pamr::poisson_boltzmann
