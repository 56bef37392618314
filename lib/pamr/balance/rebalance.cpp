// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/rebalance.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "pamr/balance/migrate.hpp"
#include "pamr/balance/weights.hpp"
#include "pamr/base/timer.hpp"

namespace pamr::balance {

Rebalanced rebalance(const par::Comm& comm, mesh::DistMesh mesh, std::span<const double> weight,
                     const Options& options) {
  const auto integers = integer_weights(comm, mesh, weight);
  return rebalance(comm, std::move(mesh), integers, options);
}

Rebalanced rebalance(const par::Comm& comm, mesh::DistMesh mesh, std::span<const std::int64_t> weight,
                     const Options& options, std::vector<std::uint8_t>* cell_byte) {
  Rebalanced result;
  auto& report = result.report;
  const auto start = wall_seconds();
  report.before = measure_ranks(comm, mesh, std::accumulate(weight.begin(), weight.end(), std::int64_t{0}));
  const auto wanted = partition(comm, mesh, weight, comm.size(), options);
  report.after = wanted.quality;
  report.method = wanted.method;
  report.moved_cells = comm.sum(static_cast<std::int64_t>(wanted.part.size()) -
                                std::count(wanted.part.begin(), wanted.part.end(), comm.rank()));
  const auto middle = wall_seconds();
  result.mesh = migrate(comm, std::move(mesh), wanted.part, cell_byte);
  report.partition_seconds = middle - start;
  report.migrate_seconds = wall_seconds() - middle;
  return result;
}

}  // namespace pamr::balance
