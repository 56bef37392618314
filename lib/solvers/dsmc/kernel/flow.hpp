// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "pamr/par/comm.hpp"
#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/kernel/boundary.hpp"
#include "solvers/dsmc/kernel/collide.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"
#include "solvers/dsmc/kernel/inflow.hpp"
#include "solvers/dsmc/kernel/move.hpp"
#include "solvers/dsmc/sampling/sample.hpp"
#include "solvers/dsmc/sampling/surface_tally.hpp"

namespace pamr::dsmc {

/// A part of space filled with a gas at the start: inside the box, or inside the sphere if `radius` is positive.
struct Region {
  Vec3 low, high;  ///< m
  Vec3 center;     ///< m
  double radius = 0;
  int stream = 0;

  bool holds(Vec3 p) const;
};

/// Everything that a computation is made of besides the mesh, in SI units.
struct Setup {
  Gas gas;
  std::vector<Stream> stream;            ///< the first is the free stream
  std::vector<BoundaryCondition> patch;  ///< one for each patch of the mesh
  int initial = 0;                       ///< stream that fills the domain at the start; -1: vacuum
  std::vector<Region> region;            ///< on top of it, later ones before earlier ones
  CollisionOptions collisions;
  double molecules = 1;         ///< real molecules that a particle stands for, where the time step is `dt`
  double dt = 0;                ///< s
  std::vector<double> cell_dt;  ///< s, of each own cell; empty: `dt` in all. Weights follow them
  double slowness = 1;          ///< mean over the volume of `dt` over a cell's time step
  double unit = 1;              ///< meters in the mesh's length unit
  std::uint64_t seed = 1;
  double expected_particles = 0;  ///< if the free stream (the fields' gas, if steps go by it) filled the domain
};

/// What a step did, on this rank.
struct StepCounts {
  MoveCounts moved;
  CollisionCounts collided;
  std::int64_t entered = 0;
  std::int64_t particles = 0;  ///< afterwards
  double compute_seconds = 0;  ///< processor time without communication
};

/// One rank's part of a gas in motion.
class Flow {
 public:
  /// Makes a domain without particles. Collective. Throws `Error` when the setup does not fit the mesh.
  Flow(const par::Comm& comm, const mesh::DistMesh& mesh, Setup setup);
  Flow(const Flow&) = delete;
  Flow& operator=(const Flow&) = delete;
  Flow(Flow&&) = delete;
  Flow& operator=(Flow&&) = delete;
  ~Flow() = default;

  /// Fills the domain with the gases of the start; ids follow the global order of the cells. Collective.
  void fill(const mesh::DistMesh& mesh);

  /// One time step: inflow, movement, sorting, collisions; sampling when switched on. Collective. Throws
  /// `ContractViolation` on every rank when a particle was lost.
  StepCounts step();

  void start_sampling();  ///< from here on, with empty sums
  /// Sampling goes on, or not, with the sums as they are.
  void resume(bool sampling) { sampling_ = sampling; }
  bool is_sampling() const { return sampling_; }
  /// Ends a block of the averages (see `Samples`); surface sums of the block are returned, one for each boundary face.
  std::vector<SurfaceTally::Sums> end_block();

  std::int64_t n_particles() const;  ///< of all ranks; collective
  std::int64_t lost() const { return lost_; }

  const par::Comm& comm() const { return *comm_; }
  const Setup& setup() const { return setup_; }
  const Domain& domain() const { return domain_; }
  /// Molecules that a particle of a species stands for in a cell.
  double molecules_of(std::size_t cell, std::size_t species) const {
    return domain_.molecules[cell] * setup_.gas.species[species].weight;
  }
  const Collider& collider() const { return collider_; }

  Particles particles;
  std::vector<CellCollisions> collisions;
  CellSamples cells;
  SurfaceTally surface;          ///< since the last block ended
  std::uint64_t steps_done = 0;  ///< since the start of the computation

 private:
  MoveRules rules() const { return {&domain_, &setup_.gas, setup_.patch, setup_.seed}; }

  const par::Comm* comm_;
  Setup setup_;
  Domain domain_;
  Collider collider_;
  std::optional<Inflow> inflow_;
  bool sampling_ = false;
  std::int64_t lost_ = 0;
};

}  // namespace pamr::dsmc
