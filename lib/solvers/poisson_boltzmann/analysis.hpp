// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <vector>

#include "solvers/poisson_boltzmann/error_estimate.hpp"
#include "solvers/poisson_boltzmann/midplane_force.hpp"
#include "solvers/poisson_boltzmann/solve.hpp"
#include "solvers/poisson_boltzmann/surface_force.hpp"

namespace pamr::poisson_boltzmann {

/// All that is computed from a solution.
struct Analysis {
  std::vector<double> psi;            ///< n_nodes
  std::vector<geometry::Vec3> field;  ///< n_nodes: -grad psi, recovered
  Estimate estimate;
  std::vector<PatchResult> patches;
  std::vector<double> goal;    ///< n_cells, empty without a goal
  double goal_value = 0;       ///< the functional, on full bodies
  double goal_error = 0;       ///< sum of `goal`, on full bodies
  double goal_correction = 0;  ///< estimated error of the functional with its sign, on full bodies
  Energy energy;
  std::optional<double> manufactured_l2, manufactured_h1;  ///< errors against the manufactured solution
};

/// Computes it. `system` is that of the problem and holds the solution; for a goal it solves one more linear system.
/// Collective. Throws `Error` when the case asks for a form that the mesh has no room or no flat mirror for.
Analysis analyze(const par::Comm& comm, const Problem& problem, System& system, const Solution& solution);

/// Puts the results into the mesh as fields (docs/tools/pamr-pb.md), in place of fields of the same names. Local.
void set_fields(mesh::DistMesh& mesh, const Case& input, const Solution& solution, const Analysis& analysis);

}  // namespace pamr::poisson_boltzmann
