// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/flow/setup.hpp"
#include "solvers/dsmc/kernel/collide.hpp"
#include "solvers/dsmc/kernel/driven_patch.hpp"
#include "solvers/dsmc/kernel/flux_planes.hpp"
#include "solvers/dsmc/kernel/flux_tally.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"
#include "solvers/dsmc/kernel/inflow.hpp"
#include "solvers/dsmc/kernel/move.hpp"
#include "solvers/dsmc/kernel/surface_tally.hpp"
#include "solvers/dsmc/sampling/cell_samples.hpp"

namespace pamr::dsmc {

/// What happened in a step on all ranks, the same on each.
struct StepTotals {
  std::int64_t entered = 0, left = 0, wall_hits = 0, collisions = 0, crossings = 0;
  std::int64_t stuck = 0;    ///< see `MoveCounts::stuck`
  std::int64_t clamped = 0;  ///< see `CollisionCounts::clamped`
  bool stop = false;         ///< some rank asked for the end of the run
};

/// What happened in a step on this rank, and the totals.
struct StepCounts {
  MoveCounts moved;
  CollisionCounts collided;
  std::int64_t entered = 0;
  std::int64_t particles = 0;  ///< after the step
  double compute_seconds = 0;  ///< processor time without communication
  Traffic traffic;             ///< what this rank has sent
  StepTotals all;
};

/// One rank's part of a gas in motion: particles and what has been sampled of them, on a domain.
class Flow {
 public:
  /// A domain without particles. Collective. Throws `Error` when the setup does not fit the mesh.
  Flow(const par::Comm& comm, const mesh::DistMesh& mesh, Setup setup);
  Flow(const Flow&) = delete;
  Flow& operator=(const Flow&) = delete;
  Flow(Flow&&) = delete;
  Flow& operator=(Flow&&) = delete;
  ~Flow() = default;

  /// Fills the domain with the initial gases; ids follow the global order of the cells. Collective.
  void fill(const mesh::DistMesh& mesh);

  /// One time step: inflow, movement, sorting, collisions, and sampling if it is switched on. `wants_stop` of any rank
  /// is reported to all (`StepTotals::stop`).
  /// Collective: the exchanges and reductions of `move` and one reduction.
  /// Throws the same `Error` on every rank when too many particles enter through a face, and `ContractViolation` when a
  /// particle was lost.
  StepCounts step(bool wants_stop = false);

  void start_sampling();  ///< from now on, with empty sums
  /// Switches sampling on or off and keeps the sums.
  void resume(bool sampling) { sampling_ = sampling; }
  /// Ends a block of the averages (see `CellSamples`). Returns the block's sums of each boundary face of this rank.
  std::vector<SurfaceTally::Sums> end_block();

  std::int64_t n_particles() const;  ///< on all ranks. Collective
  std::int64_t lost() const { return lost_; }

  const par::Comm& comm() const { return *comm_; }
  const Setup& setup() const { return setup_; }
  const GasDomain& domain() const { return domain_; }
  /// Real molecules that a particle of a species stands for in a cell.
  double fnum_of(std::size_t cell, std::size_t species) const {
    return domain_.fnum[cell] * setup_.gas.species[species].weight;
  }
  const Collider& collider() const { return collider_; }
  /// The inlets and outlets, by patch.
  const std::vector<DrivenPatch>& driven() const { return driven_; }
  /// Their averages (`DrivenPatch::means`), one after another.
  std::vector<double> driven_means() const;
  /// The reverse. Local. Throws `Error` for numbers that no averages are.
  void set_driven_means(std::span<const double> means);

  Particles particles;
  std::vector<CellCollisions> collisions;
  CellSamples cells;
  SurfaceTally surface;          ///< since the last block ended
  FluxTally flux;                ///< since the last interval ended, of each patch and then of each plane
  std::uint64_t steps_done = 0;  ///< since the start of the computation

 private:
  MoveRules rules() const {
    return {&domain_, &setup_.gas, setup_.patch, setup_.seed, steps_done, planes_.plane.empty() ? nullptr : &planes_};
  }
  StepTotals add_up(const StepCounts& here, std::int64_t missing, bool wants_stop, const std::optional<Error>& trouble);
  void add_driven_patches();

  const par::Comm* comm_;
  Setup setup_;
  GasDomain domain_;
  Collider collider_;
  FluxPlanes planes_;
  std::vector<DrivenPatch> driven_;
  std::optional<Inflow> inflow_;
  std::optional<BorderExchange> border_;
  bool sampling_ = false;
  std::int64_t lost_ = 0;
  std::int64_t hits_unchecked_ = 0;  ///< on walls of this rank since their sums were looked at
};

}  // namespace pamr::dsmc
