// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>

#include "pamr/mesh/dist_mesh.hpp"
#include "solvers/dsmc/kernel/flow.hpp"
#include "solvers/dsmc/run/flow_case.hpp"
#include "solvers/dsmc/run/run.hpp"
#include "solvers/dsmc/state/checkpoint.hpp"

namespace pamr::dsmc {

/// Decides when cells should move to other ranks: at the first rise of the mean cost of a step since the last move,
/// (processor time lost to imbalance + price of the last move) / steps.
/// Source: D. M. Nicol, J. H. Saltz, "Dynamic remapping of parallel computations with varying resource demands", IEEE
/// Trans. Comput. 37 (1988): the stop-at-rise rule.
class StopAtRise {
 public:
  /// Some steps in which the busiest rank computed for `longest` seconds and the mean one for `mean`. True when it is
  /// time to move.
  bool add(double n_steps, double longest, double mean);
  void moved(double price);

 private:
  double lost_ = 0, price_ = 0, steps_ = 0, last_ = -1;
};

/// A mesh, the gas on it and its run, which move to other ranks together.
class Computation {
 public:
  /// Collective. Throws `Error` when the case does not fit the mesh.
  Computation(const par::Comm& comm, const Case& the_case, mesh::DistMesh mesh);

  /// One step; every 20 steps on several ranks, cells move when that repays. The result does not depend on it, bit for
  /// bit. Collective. True when the run is complete.
  bool step();
  /// Moves cells now so that every rank has the same number of particles and cells, if the ranks differ by more than
  /// 3 %. Collective. True when cells moved.
  bool rebalance();

  Snapshot snapshot() const { return take_snapshot(*comm_, key_, *run, *flow); }
  const MeshKey& key() const { return key_; }
  std::int64_t n_moves() const { return n_moves_; }

  mesh::DistMesh mesh;
  std::unique_ptr<Flow> flow;
  std::unique_ptr<Run> run;

 private:
  void make();

  const par::Comm* comm_;
  const Case* case_;
  MeshKey key_;
  StopAtRise rule_;
  double computed_ = 0;  ///< processor seconds of this rank since the last look
  int steps_ = 0;
  std::int64_t n_moves_ = 0;
};

}  // namespace pamr::dsmc
