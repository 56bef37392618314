// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

#include "solvers/poisson_boltzmann/analysis.hpp"

namespace pamr::poisson_boltzmann {

/// The boundary as the text of a VTU file on rank 0 (empty on the others): a triangle for each boundary face, its
/// corners its own, with the fields `potential` (corners), `charge_density`, `stress` (force on the body per area),
/// `patch` (triangles). Where u is given the charge density is that of the nodal reactions. Coordinates in the length
/// unit of the mesh. Triangles in the order of the cells. Collective: every rank sends its faces to rank 0.
std::string surface_text(const par::Comm& comm, const Domain& domain, const Case& problem, const Conditions& conditions,
                         const Solution& solution, const Analysis& analysis);

}  // namespace pamr::poisson_boltzmann
