// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/flow/setup.hpp"
#include "solvers/dsmc/run/body_laws.hpp"
#include "solvers/dsmc/run/flow_case.hpp"
#include "solvers/dsmc/state/checkpoint.hpp"

namespace pamr::dsmc {

/// What is known of a computation before its first step.
struct Plan {
  double mach = 0, speed_ratio = 0, knudsen = 0, reynolds = 0;  ///< on the reference length, of the free stream
  double mean_free_path = 0, collision_time = 0;                ///< m, s
  std::string hot_part;          ///< the first stream or wall that `is_hot`, in words; empty: none
  std::string missing_when_hot;  ///< the warning about it
  double particles = 0;          ///< in the domain filled with the free stream
  double particles_per_cell = 0;
  double particles_at_start = 0;  ///< of the flow that it goes on from, about; 0 where it begins with the case's gas
  double particle_bytes = 0;      ///< that a particle takes, all arrays together
  double bytes = 0;               ///< of cells and the most particles that are known of, all ranks
  double steps = 0, cpu_seconds = 0;  ///< of these particles, at 4 million particle-steps a second
  double longest_flight =
      0;  ///< cell sizes that a fast molecule of the free stream passes in a step, maximum over the cells
  std::optional<BodyLaws> body;
  bool gives_lift = true;         ///< `Reference::gives_lift`
  std::string wall_out_of_plane;  ///< a patch that its velocity leads away from its place; empty: none

  /// The most that are known of before the first step.
  double max_particles() const { return std::max(particles, particles_at_start); }
};

/// The checkpoints of a computation.
struct Checkpoints {
  std::optional<CheckpointHead> from{};  ///< the flow that it goes on from, on this mesh or on another
  bool are_written = false;              ///< particles are copied for them; where the mesh adapts they are in any case
};

/// Throws `Error` for regions of the case that fill no cell, unless it goes on from a flow (`require_regions`).
/// Collective.
Plan make_plan(const par::Comm& comm, const Case& the_case, const Setup& setup, const mesh::DistMesh& mesh,
               const Checkpoints& checkpoints = {});

/// What a user should be warned about. Local.
std::vector<std::string> warnings_of(const Plan& plan);
/// Lines for the user: species, gas, free stream, numbers of the flow, effort, coefficients. Local.
std::vector<std::string> describe(const Case& the_case, const Setup& setup, const Plan& plan);
nlohmann::json to_json(const Plan& plan);

}  // namespace pamr::dsmc
