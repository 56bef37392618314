// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "pamr/balance/partition.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::balance {

/// What a balancing step did; the same on every rank but for the seconds.
struct Report {
  Method method = Method::none;  ///< what was done: `none` where all stayed
  Quality before, after;         ///< with the given weights
  std::int64_t moved_cells = 0;  ///< all ranks
  double partition_seconds = 0;  ///< wall clock, this rank
  double migrate_seconds = 0;
};

struct Rebalanced {
  mesh::DistMesh mesh;
  Report report;
};

/// Moves the cells of a mesh so that every rank bears about the same weight: what a solver calls when its work has
/// shifted. `weight`: one number of at least 0 for each cell of this rank, in any unit (particles of the cell, seconds,
/// unknowns). All node and cell fields move along, so data of a solver that belongs to cells goes into a field first;
/// cells keep their global numbers.
///
///     auto particles_per_cell = ...;                                        // std::vector<double>
///     auto [mesh, report] = balance::rebalance(comm, std::move(old), particles_per_cell, {.keep_below = 1.1});
///
/// Collective. Throws `Error` as `integer_weights` does; then `mesh` is gone. Cost: `partition` and `migrate`.
Rebalanced rebalance(const par::Comm& comm, mesh::DistMesh mesh, std::span<const double> weight,
                     const Options& options = {});

/// The same with integer weights as `partition` takes them, and with one byte a cell that travels along (see
/// `migrate`). Collective.
Rebalanced rebalance(const par::Comm& comm, mesh::DistMesh mesh, std::span<const std::int64_t> weight,
                     const Options& options, std::vector<std::uint8_t>* cell_byte = nullptr);

}  // namespace pamr::balance
