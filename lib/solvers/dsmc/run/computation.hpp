// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "solvers/dsmc/flow/flow.hpp"
#include "solvers/dsmc/run/averaging.hpp"
#include "solvers/dsmc/run/flow_case.hpp"
#include "solvers/dsmc/run/should_move.hpp"
#include "solvers/dsmc/state/checkpoint.hpp"
#include "solvers/dsmc/state/transfer_particles.hpp"

namespace pamr::dsmc {

/// What a step of a computation came to, the same on every rank.
struct StepResult {
  bool is_complete = false;  ///< the case asks for no more
  bool stop = false;         ///< some rank asked for the end
  bool window_full = false;  ///< averages begin anew with the next step
};

/// What adapting the mesh has done so far.
struct AdaptationReport {
  std::int64_t n_times = 0;
  std::int64_t cells_marked = 0, octets_gone = 0;  ///< in all of them
  std::int64_t min_cells = 0, max_cells = 0;       ///< of the meshes
  std::int64_t removed = 0;                        ///< particles that a wall with new nodes holds now
  double seconds = 0;                              ///< processor time of this rank
};

/// A mesh, the gas on it and its averages: owns them, advances them together and moves them to other ranks together.
class Computation {
 public:
  /// Without particles; `setup` from `make_setup` for this case and mesh. Collective. Throws `Error` when they do not
  /// fit.
  Computation(const par::Comm& comm, Case the_case, Setup setup, mesh::DistMesh mesh);

  /// The three ways to begin; each collective.
  /// With the initial gases of the case.
  void fill() { flow_->fill(mesh_); }
  /// From a checkpoint of the same case on the same mesh. Throws the same `Error` on every rank for a file that does
  /// not fit.
  void restart(const std::string& checkpoint);
  /// With the flow of a checkpoint on the mesh that this one was refined from. Throws like `restart`.
  Transferred transfer_from(const std::string& checkpoint);
  /// The same with a snapshot of a computation with the same species, on this mesh or the one it was refined from.
  Transferred transfer_from(Snapshot snapshot);

  /// One time step, and what is due around it: before it, after a full window of the averages, a new window, for which
  /// the mesh is adapted if the case says so (`adapt`); after it the end of an interval, and on several ranks every 20
  /// steps a move of cells if it pays off, unless `keep_cells` was called. The result does not depend on that, bit for
  /// bit.
  /// `wants_stop` of any rank is reported to all. Collective.
  StepResult step(bool wants_stop = false);
  /// Moves cells now so that every rank has the same work (particles, candidate pairs and cells), if the ranks differ
  /// by more than 3 %. Collective. Returns true when cells moved.
  bool rebalance();
  /// From now on `step` leaves cells on their ranks.
  void keep_cells() { is_dynamic_ = false; }
  /// `Averaging::finish`. Collective.
  void finish() { averaging_->finish(*flow_); }

  /// Collective.
  Snapshot snapshot() const;
  bool is_complete() const { return averaging_->is_complete(flow_->steps_done); }

  const par::Comm& comm() const { return *comm_; }
  const AdaptationReport& adaptation() const { return adaptation_; }
  /// The step after which the mesh was adapted last; 0: it is the mesh that was given.
  std::uint64_t mesh_step() const { return mesh_step_; }
  /// The same when the run went on from a checkpoint; nothing for other runs.
  std::optional<std::uint64_t> restarted_mesh() const { return restarted_mesh_; }
  const Case& the_case() const { return case_; }
  const Flow& flow() const { return *flow_; }
  const Averaging& averaging() const { return *averaging_; }
  mesh::DistMesh& mesh() { return mesh_; }
  const mesh::DistMesh& mesh() const { return mesh_; }
  bool is_dynamic() const { return is_dynamic_; }
  std::int64_t n_moves() const { return n_moves_; }  ///< of cells to other ranks
  /// Processor seconds of the slowest rank in all calls of `rebalance`, communication included, which holds up the run.
  double move_seconds() const { return move_seconds_; }
  /// Of this rank in all steps: processor seconds without communication, and what it has sent.
  double computed() const { return computed_; }
  const Traffic& traffic() const { return traffic_; }

 private:
  const par::Comm* comm_;
  Case case_;
  mesh::DistMesh mesh_;
  MeshKey key_;
  std::optional<std::uint64_t> begun_on_;  ///< fingerprint of the mesh that the run began with, unless no one told it
  nlohmann::json facts_;                   ///< `facts_of` the case on the mesh
  std::optional<Flow> flow_;
  std::optional<Averaging> averaging_;
  ShouldMove rule_;
  /// Refines and coarsens the mesh by the averages; particles keep their places. Collective.
  void adapt();
  /// The averages under their names in files. Collective.
  std::vector<mesh::CellField> averages_as_fields() const;

  bool is_dynamic_ = true;
  AdaptationReport adaptation_;
  std::uint64_t mesh_step_ = 0;  ///< after which the mesh was adapted
  std::optional<std::uint64_t> restarted_mesh_;
  double computed_ = 0;  ///< processor seconds of this rank
  Traffic traffic_;
  double checked_ = 0;  ///< `computed_` at the last check of the balance
  int steps_ = 0;       ///< since then
  std::int64_t n_moves_ = 0;
  double move_seconds_ = 0;
};

}  // namespace pamr::dsmc
