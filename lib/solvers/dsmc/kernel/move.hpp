// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/par/comm.hpp"
#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/kernel/boundary.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"
#include "solvers/dsmc/kernel/particles.hpp"
#include "solvers/dsmc/kernel/surface_tally.hpp"

namespace pamr::dsmc {

/// A particle with time left to fly from its position.
struct Flight {
  Particle particle;
  double time = 0;                  ///< s, from `particle.position`
  double passed = 0;                ///< part of it known to lie behind
  double dt_from = 0;               ///< time step of the cell it comes from, between ranks
  std::uint32_t events = 0;         ///< walls met in this step
  std::uint32_t excluded_face = 0;  ///< bit of the cell's face that it just left, a wall
};

/// What decides how particles move.
struct MoveRules {
  const GasDomain* domain = nullptr;
  const Gas* gas = nullptr;
  std::span<const BoundaryCondition> patch;  ///< one for each patch of the mesh
  std::uint64_t seed = 0;
};

/// What happened to particles in a step, on this rank.
struct MoveCounts {
  std::int64_t crossings = 0;  ///< of faces between cells
  std::int64_t wall_hits = 0;
  std::int64_t left = 0;       ///< through open boundaries
  std::int64_t sent = 0;       ///< to other ranks, each time counted
  std::int64_t stuck = 0;      ///< met more than 100,000 walls in one step: keep their place, lose their remaining time
  double compute_seconds = 0;  ///< processor time without communication
  std::int64_t longest = 0;    ///< most faces that one particle passed

  void add(const MoveCounts& other);
};

/// Moves all particles by the time step of their cell, and `entering` ones by the time they have left, from face to
/// face through the neighbors; particles that leave the rank go on where they arrive until none is left on its way.
///
/// A flight is a straight line from where it began (or from the last wall), and a particle leaves a cell through the
/// face that this line meets first among those whose outside holds the end of the flight and through which it moves
/// outwards. No tolerance enters: of the two planes of a face one is the exact negative of the other, so a particle
/// never turns back by rounding, and a line through an edge or a corner goes round it. Since the line is never cut at a
/// face, positions do not depend on the mesh or the partition that it crosses, up to the walls. Where rounding leads
/// round and round without progress (64 faces), a face is drawn among those behind the particle, which ends it.
///
/// Afterwards the particles are unsorted; those that left have cell `Particles::gone`. `tally` takes what walls get.
/// Collective: a sparse exchange and a reduction for each round, one more round than the most rank borders that a
/// particle passes; none on one rank.
MoveCounts move(const par::Comm& comm, const MoveRules& rules, std::uint64_t step, Particles& particles,
                std::vector<Flight>& entering, SurfaceTally& tally);

}  // namespace pamr::dsmc
