// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "solvers/poisson_boltzmann/goals/error_estimate.hpp"
#include "solvers/poisson_boltzmann/goals/free_energy.hpp"
#include "solvers/poisson_boltzmann/goals/functionals.hpp"

namespace pamr::poisson_boltzmann {

/// A goal with the error that its dual solution estimates; on full bodies, the energy on the meshed part.
struct GoalResult {
  Goal goal;
  std::optional<double> value;      ///< of the functional; nothing where it means nothing
  double correction = 0;            ///< estimated error with its sign
  bool is_corrected = true;         ///< the best value is `value` + `correction`; else the correction does not hold
  double error_bound = 0;           ///< sum of the cells' shares
  double of_box = 0;                ///< what walls of the far field cost (`far_field_cost`), part of the bar
  std::optional<double> error_bar;  ///< of the best value; nothing where `no_error_bar` says why
  std::string no_error_bar;
  /// The shares are more than a tenth of the value, of a component more than a tenth of the vector: a bar is what the
  /// orders of fine cells say, and a second level shows whether these are.
  bool is_coarse = false;

  /// The correction, where it holds.
  double best_correction() const { return is_corrected ? correction : 0; }
};

/// All that is computed from a solution.
struct Analysis {
  std::vector<double> psi;            ///< n_nodes
  std::vector<geometry::Vec3> field;  ///< n_nodes: -grad psi, recovered
  Estimate estimate;
  std::vector<Electrode> electrodes;
  Layers layers;
  std::vector<PatchResult> patches;  ///< of the mesh, then bodies of several patches; refers to `electrodes`
  std::string no_midplane;           ///< why no single body has the mid-plane force; empty where one has
  std::vector<GoalResult> goals;
  /// n_cells: share of each cell in the error of the goals, empty without one. Those of several goals count alike: each
  /// is scaled to the sum of the first.
  std::vector<double> goal;
  std::optional<FreeEnergy> free_energy;                   ///< likewise, and in cases without a plate
  std::optional<Energy> energy;                            ///< nothing where a layer is not resolved at all
  std::optional<double> manufactured_l2, manufactured_h1;  ///< errors against the manufactured solution

  /// False when a number of the results is infinite or none.
  bool is_finite() const;
};

/// Computes it. `system` is that of the problem and holds the solution; for each electrode and each goal it solves one
/// more linear system. `max_cells` is the largest mesh that the user would make (`find_layers`). Collective. Throws
/// `Error` when the case asks for a form that the mesh has no room or no flat mirror for.
Analysis analyze(const par::Comm& comm, const Problem& problem, System& system, const Solution& solution,
                 double max_cells);

/// Puts the results into the mesh as fields (docs/tools/pamr-pb.md), in place of fields of the same names. Local.
void set_fields(mesh::DistMesh& mesh, const Case& input, const Solution& solution, const Analysis& analysis);

}  // namespace pamr::poisson_boltzmann
