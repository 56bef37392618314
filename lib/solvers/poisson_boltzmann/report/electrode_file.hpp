// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>

#include "solvers/poisson_boltzmann/goals/analysis.hpp"

namespace pamr::poisson_boltzmann {

/// Writes the boundary as a VTU file: a triangle for each boundary face, its corners its own, in the order of the
/// cells; coordinates in the length unit of the mesh. Fields:
/// - corners: `potential`;
/// - triangles: `charge_density` (by the nodal reactions where u is given), `stress` (force on the body per area),
///   `patch`.
/// Collective: a few exchanges. Throws `Error` when the file cannot be written.
void write_electrodes(const par::Comm& comm, const std::filesystem::path& file, const Problem& problem,
                      const Solution& solution, const Analysis& analysis);

}  // namespace pamr::poisson_boltzmann
