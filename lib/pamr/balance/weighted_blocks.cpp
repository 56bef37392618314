// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/weighted_blocks.hpp"

#include <algorithm>
#include <limits>
#include <numeric>

#include "pamr/base/contract.hpp"
#include "pamr/mesh/cell_runs.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::balance {

namespace {

constexpr std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

}  // namespace

std::vector<Rank> weighted_blocks(const par::Comm& comm, std::span<const std::int64_t> weight, Rank n_parts) {
  const auto parts = n_parts > 0 ? n_parts : comm.size();
  const auto here = std::accumulate(weight.begin(), weight.end(), std::int64_t{0});
  const auto total = comm.sum(here);
  PAMR_EXPECTS(weight.empty() || (total > 0 && total <= std::numeric_limits<std::int64_t>::max() / (2 * parts)));
  auto before = comm.exclusive_sum(here);
  std::vector<Rank> part;
  part.reserve(weight.size());
  for (const auto w : weight) {
    // the cell goes where its middle falls
    part.push_back(static_cast<Rank>(std::min<std::int64_t>((2 * before + w) * parts / (2 * total), parts - 1)));
    before += w;
  }
  return part;
}

std::vector<Rank> weighted_blocks(const par::Comm& comm, const mesh::DistMesh& mesh,
                                  std::span<const std::int64_t> weight, Rank n_parts) {
  PAMR_EXPECTS(weight.size() == at(mesh.n_cells()));
  std::vector<Rank> part;
  if (!mesh::cell_runs(comm, mesh).empty()) {
    part = weighted_blocks(comm, weight, n_parts);
  } else {
    const auto all = mesh.info.cell_ids();
    const auto block = par::scatter_rows<std::int64_t>(comm, all, weight, 1, mesh.cell_global);
    part = par::fetch_rows<Rank>(comm, all, weighted_blocks(comm, block, n_parts), 1, mesh.cell_global);
  }
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    const auto lineage = mesh.lineage[at(c)];
    if (lineage.is_removable()) part[at(c)] = part[at(c - lineage.child())];
  }
  return part;
}

}  // namespace pamr::balance
