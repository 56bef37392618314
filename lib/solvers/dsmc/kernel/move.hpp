// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/par/comm.hpp"
#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/kernel/border_exchange.hpp"
#include "solvers/dsmc/kernel/boundary.hpp"
#include "solvers/dsmc/kernel/flight.hpp"
#include "solvers/dsmc/kernel/flux_planes.hpp"
#include "solvers/dsmc/kernel/flux_tally.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"
#include "solvers/dsmc/kernel/particles.hpp"
#include "solvers/dsmc/kernel/surface_tally.hpp"

namespace pamr::dsmc {

/// What decides how particles move.
struct MoveRules {
  const GasDomain* domain = nullptr;
  const Gas* gas = nullptr;
  std::span<const BoundaryCondition> patch;  ///< one for each patch of the mesh
  std::uint64_t seed = 0;
  std::uint64_t step = 0;              ///< number of the time step
  const FluxPlanes* planes = nullptr;  ///< null: none
};

/// Where the traces of moving particles are recorded. Only references.
struct MoveTargets {
  BorderExchange& border;     ///< particles that leave the rank; of the rules' domain, with nothing to deliver
  SurfaceTally& tally;        ///< what walls are given
  FluxTally* flux = nullptr;  ///< what passes patches and planes; null: not counted
};

/// What happened to particles in a step, on this rank.
struct MoveCounts {
  std::int64_t crossings = 0;  ///< of faces between cells
  std::int64_t wall_hits = 0;
  std::int64_t left = 0;       ///< through open boundaries
  std::int64_t sent = 0;       ///< to other ranks, counted each time
  std::int64_t stuck = 0;      ///< hit walls 100,000 times in one step: stopped there until the next
  double compute_seconds = 0;  ///< processor time without communication
  std::int64_t longest = 0;    ///< maximum number of faces that one particle passed

  void add(const MoveCounts& other);
};

/// Moves all particles by the time step of their cell, and `entering` ones by the time that they have left, from face
/// to face through the neighbors. Particles that leave the rank fly on through its halo, off walls too, and are
/// delivered where they come to rest; one that leaves the halo continues on the rank that it comes to.
///
/// - A flight is a straight line from its start, or from the last wall. A particle leaves a cell through the face that
///   this line meets first, among the faces that have the end of the flight outside and that it moves towards.
/// - No tolerance is needed: both cells of a face use bitwise opposite planes, so rounding can never send a particle
///   back, and a line through an edge or a corner is taken around it.
/// - The line is never cut at a face, so positions do not depend on the mesh or the partition that it crosses, up to
///   the walls. Planes are therefore compared with the two ends of a line; for particles that stay in their cell only
///   in the cells that a plane cuts.
/// - If rounding leads in circles (64 faces without progress), one of the faces behind the particle is chosen at
///   random, which ends it.
///
/// Afterwards the particles are unsorted; those that left have cell `Particles::gone`.
/// Collective: an exchange between neighbors and a reduction, and one more of each for every further halo that a
/// particle leaves in the step; nothing on one rank.
MoveCounts move(const par::Comm& comm, const MoveRules& rules, Particles& particles, std::vector<Flight>& entering,
                const MoveTargets& targets);

}  // namespace pamr::dsmc
