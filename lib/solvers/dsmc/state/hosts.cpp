// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/state/hosts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/par/exchange.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"
#include "solvers/dsmc/state/cell_row.hpp"
#include "solvers/dsmc/state/checkpoint_rows.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

/// A new cell that could take the particles of its parent.
struct Candidate {
  GlobalId parent = 0, cell = 0;
  double volume = 0;
  Rank rank = 0;
};

}  // namespace

std::vector<Host> find_hosts(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<GlobalId>& parent,
                             GlobalId n_old, double unit) {
  const auto number = cells_from_0(mesh);
  std::vector<par::Outgoing<Candidate>> messages(static_cast<std::size_t>(comm.size()));
  for (Rank r = 0; r < comm.size(); ++r) messages[at(r)].to = r;
  for (std::size_t c = 0; c < parent.size(); ++c) {
    const auto to = par::block_of(parent[c], n_old, comm.size());
    const double v = volume(corners(mesh, unit, static_cast<LocalId>(c)));
    messages[at(to)].item.push_back({parent[c], number[c], v, comm.rank()});
  }
  std::erase_if(messages, [](const auto& m) { return m.item.empty(); });
  const auto block = par::block_range(n_old, comm.rank(), comm.size());
  auto candidates = comm.sparse_exchange(messages).item;
  // Volumes are added in the order of the cells, so that their sums do not depend on the ranks.
  std::sort(candidates.begin(), candidates.end(), [](const auto& a, const auto& b) { return a.cell < b.cell; });
  std::vector<Host> hosts(static_cast<std::size_t>(block.end - block.begin));
  for (const auto& candidate : candidates) {
    auto& host = hosts[at(candidate.parent - block.begin)];
    if (host.cell < 0) host = {candidate.cell, candidate.rank, 0};
    host.volume += candidate.volume;
  }
  return hosts;
}

void add_hosts_of_gone(const par::Comm& comm, std::span<const GoneCell> gone, GlobalId n_old,
                       std::vector<Host>& hosts) {
  std::vector<GlobalId> into, number;
  for (const auto& cell : gone) {
    into.push_back(cell.into);
    number.push_back(cell.number);
  }
  auto found = par::fetch_rows<Host>(comm, n_old, hosts, 1, into);
  for (auto& host : found) host.volume = 0;
  const auto of_block = par::scatter_rows<Host>(comm, n_old, found, 1, number);
  for (std::size_t c = 0; c < hosts.size(); ++c)
    if (hosts[c].cell < 0) hosts[c] = of_block[c];
}

void fill_gaps(const par::Comm& comm, std::vector<Host>& hosts) {
  Host first, last;
  for (const auto& host : hosts)
    if (host.cell >= 0) {
      if (first.cell < 0) first = host;
      last = host;
    }
  const auto first_cell = comm.all_gather(std::int64_t{first.cell}),
             last_cell = comm.all_gather(std::int64_t{last.cell});
  const auto first_rank = comm.all_gather(std::int64_t{first.rank}),
             last_rank = comm.all_gather(std::int64_t{last.rank});
  Host before;
  for (Rank r = comm.size(); r-- > 0;)
    if (first_cell[at(r)] >= 0) before = {first_cell[at(r)], static_cast<Rank>(first_rank[at(r)]), 0};
  for (Rank r = 0; r < comm.rank(); ++r)
    if (last_cell[at(r)] >= 0) before = {last_cell[at(r)], static_cast<Rank>(last_rank[at(r)]), 0};
  for (auto& host : hosts) {
    if (host.cell < 0)
      host = before;
    else
      before = {host.cell, host.rank, 0};
  }
}

void require_old_volumes(const par::Comm& comm, const std::string& file, const Section& old_cells,
                         const std::vector<Host>& hosts) {
  constexpr double scale = 1e6;
  std::int64_t wrong[2] = {0, 0};
  for (std::size_t c = 0; c < hosts.size(); ++c) {
    const double old = real(old_cells.block[c * old_cells.width + CellColumns::volume]);
    if (!(old > 0)) continue;
    wrong[0] += static_cast<std::int64_t>(scale * std::min(1.0, std::fabs(hosts[c].volume - old) / old));
    wrong[1] += static_cast<std::int64_t>(scale);
  }
  comm.sum_in_place(wrong);
  if (2 * wrong[0] > wrong[1])
    throw Error(
        fmt::format("file '{}': expected a checkpoint on the mesh that this one was refined from, found cells of "
                    "other volumes",
                    file));
}

}  // namespace pamr::dsmc
