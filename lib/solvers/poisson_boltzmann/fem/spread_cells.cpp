// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/spread_cells.hpp"

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "pamr/balance/migrate.hpp"

namespace pamr::poisson_boltzmann {

balance::Rebalanced spread_cells(const par::Comm& comm, mesh::DistMesh mesh, balance::Method method) {
  const std::vector<std::int64_t> ones(static_cast<std::size_t>(mesh.n_cells()), 1);
  balance::Rebalanced result;
  auto& report = result.report;
  report.before = report.after = balance::measure_ranks(comm, mesh, mesh.n_cells());
  result.mesh = std::move(mesh);
  if (comm.size() == 1 || method == balance::Method::none) return result;
  // Four times as many groups of cells as where a mesh is soon refined and written: a solve takes far longer.
  const balance::Options options{.method = method, .keep_below = 0, .vertices_per_part = 2000};
  const auto wanted = balance::partition(comm, result.mesh, ones, comm.size(), options);
  const bool is_no_better = wanted.quality.edge_cut >= report.before.edge_cut &&
                            report.before.imbalance <= std::max(1.02, wanted.quality.imbalance);
  if (method == balance::Method::scotch && is_no_better) return result;
  report.after = wanted.quality;
  report.method = wanted.method;
  report.moved_cells = comm.sum(static_cast<std::int64_t>(wanted.part.size()) -
                                std::count(wanted.part.begin(), wanted.part.end(), comm.rank()));
  result.mesh = balance::migrate(comm, std::move(result.mesh), wanted.part);
  return result;
}

}  // namespace pamr::poisson_boltzmann
