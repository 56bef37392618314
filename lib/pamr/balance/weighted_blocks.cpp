// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/weighted_blocks.hpp"

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/cell_runs.hpp"
#include "pamr/par/equal_work.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::balance {

std::vector<Rank> weighted_blocks(const par::Comm& comm, const mesh::DistMesh& mesh,
                                  std::span<const std::int64_t> weight, Rank n_parts) {
  PAMR_EXPECTS(weight.size() == at(mesh.n_cells()));
  const auto parts = n_parts > 0 ? n_parts : comm.size();
  std::vector<Rank> part;
  if (!mesh::cell_runs(comm, mesh).empty()) {
    part = par::runs_of_equal_work(comm, weight, parts);
  } else {
    const auto all = mesh.info.cell_ids();
    const auto block = par::scatter_rows<std::int64_t>(comm, all, weight, 1, mesh.cell_global);
    part = par::fetch_rows<Rank>(comm, all, par::runs_of_equal_work(comm, block, parts), 1, mesh.cell_global);
  }
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto lineage = mesh.lineage[at(c)];
    if (lineage.is_removable()) part[at(c)] = part[at(c - lineage.child())];
  }
  return part;
}

}  // namespace pamr::balance
