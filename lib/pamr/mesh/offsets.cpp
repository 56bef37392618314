// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/offsets.hpp"

#include <numeric>

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::mesh {

namespace {

/// `start` and the counts before each entry, those of lower ranks included. Collective.
std::vector<GlobalId> accumulate(const par::Comm& comm, std::span<const std::uint8_t> counts, GlobalId start) {
  const auto sum = std::accumulate(counts.begin(), counts.end(), GlobalId{0});
  auto next = start + comm.exclusive_sum(sum);
  std::vector<GlobalId> offset;
  reserve_array(offset, counts.size());
  for (const auto count : counts) {
    offset.push_back(next);
    next += count;
  }
  return offset;
}

/// The same for entries that are numbered by `ids` among `all`.
std::vector<GlobalId> accumulate_by_number(const par::Comm& comm, IdRange all, std::span<const GlobalId> ids,
                                           std::span<const std::uint8_t> counts, GlobalId start) {
  if (comm.size() == 1) {
    std::vector<std::uint8_t> in_order(at(all.n), 0);
    for (std::size_t i = 0; i < ids.size(); ++i) in_order[at(ids[i] - all.first)] = counts[i];
    const auto offset = accumulate(comm, in_order, start);
    std::vector<GlobalId> result;
    reserve_array(result, ids.size());
    for (const auto id : ids) result.push_back(offset[at(id - all.first)]);
    return result;
  }
  const auto block = par::scatter_rows<std::uint8_t>(comm, all, counts, 1, ids);
  return par::fetch_rows<GlobalId>(comm, all, accumulate(comm, block, start), 1, ids);
}

}  // namespace

std::vector<GlobalId> cell_offsets(const par::Comm& comm, const DistMesh& mesh, bool in_runs,
                                   std::span<const std::uint8_t> counts, GlobalId start) {
  if (in_runs) return accumulate(comm, counts, start);
  return accumulate_by_number(comm, mesh.info.cell_ids(), mesh.cell_global, counts, start);
}

std::vector<GlobalId> node_offsets(const par::Comm& comm, const DistMesh& mesh, std::span<const std::uint8_t> counts,
                                   GlobalId start) {
  return accumulate_by_number(comm, mesh.info.node_ids(), mesh.node_global, counts, start);
}

}  // namespace pamr::mesh
