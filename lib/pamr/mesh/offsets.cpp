// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/offsets.hpp"

#include <algorithm>
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

/// Cells of one rank with consecutive numbers.
struct Run {
  GlobalId first = 0;  ///< number of the first cell
  GlobalId sum = 0;    ///< of their counts
};

/// The first cell behind the run that begins with cell `c`.
std::size_t end_of_run(std::span<const GlobalId> ids, std::size_t c) {
  for (++c; c < ids.size() && ids[c] == ids[c - 1] + 1;) ++c;
  return c;
}

/// For each of this rank's runs: `start` and the sums of all runs of all ranks with smaller numbers. Collective.
std::vector<GlobalId> accumulate_runs(const par::Comm& comm, IdRange all, std::span<const Run> runs, GlobalId start) {
  std::vector<par::Outgoing<Run>> questions(at(comm.size()));
  std::vector<std::vector<std::size_t>> asked(at(comm.size()));
  for (std::size_t i = 0; i < runs.size(); ++i) {
    const auto to = at(par::block_of(runs[i].first, all, comm.size()));
    questions[to].item.push_back(runs[i]);
    asked[to].push_back(i);
  }
  for (Rank r = 0; r < comm.size(); ++r) questions[at(r)].to = r;
  std::erase_if(questions, [](const auto& message) { return message.item.empty(); });
  const auto received = comm.sparse_exchange(questions);
  std::vector<std::size_t> order(received.item.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  std::sort(order.begin(), order.end(),
            [&](std::size_t a, std::size_t b) { return received.item[a].first < received.item[b].first; });
  GlobalId sum = 0;
  for (const auto& run : received.item) sum += run.sum;
  auto next = start + comm.exclusive_sum(sum);
  std::vector<GlobalId> offset(received.item.size());
  for (const auto i : order) {
    offset[i] = next;
    next += received.item[i].sum;
  }
  std::vector<par::Outgoing<GlobalId>> answers;
  for (std::size_t i = 0, done = 0; i < received.rank.size(); ++i) {
    const auto n = received.from(i).size();
    answers.push_back(
        {received.rank[i],
         {offset.begin() + static_cast<std::ptrdiff_t>(done), offset.begin() + static_cast<std::ptrdiff_t>(done + n)}});
    done += n;
  }
  const auto answered = comm.sparse_exchange(answers);
  std::vector<GlobalId> result(runs.size());
  for (std::size_t i = 0; i < answered.rank.size(); ++i) {
    const auto from = answered.from(i);
    for (std::size_t k = 0; k < from.size(); ++k) result[asked[at(answered.rank[i])][k]] = from[k];
  }
  return result;
}

/// The same as `accumulate_by_number` where each number is on one rank only: what crosses ranks is sums of runs.
std::vector<GlobalId> accumulate_by_runs(const par::Comm& comm, IdRange all, std::span<const GlobalId> ids,
                                         std::span<const std::uint8_t> counts, GlobalId start) {
  std::vector<Run> runs;
  for (std::size_t c = 0; c < ids.size();) {
    const auto end = end_of_run(ids, c);
    const auto values = counts.subspan(c, end - c);
    runs.push_back({ids[c], std::accumulate(values.begin(), values.end(), GlobalId{0})});
    c = end;
  }
  const auto first = accumulate_runs(comm, all, runs, start);
  std::vector<GlobalId> offset;
  reserve_array(offset, counts.size());
  std::size_t run = 0;
  GlobalId next = 0;
  for (std::size_t c = 0; c < ids.size(); ++c) {
    if (c == 0 || ids[c] != ids[c - 1] + 1) next = first[run++];
    offset.push_back(next);
    next += counts[c];
  }
  return offset;
}

}  // namespace

std::vector<GlobalId> cell_offsets(const par::Comm& comm, const DistMesh& mesh, Exact<bool> in_runs,
                                   std::span<const std::uint8_t> counts, Exact<GlobalId> start) {
  if (in_runs) return accumulate(comm, counts, start);
  return accumulate_by_runs(comm, mesh.info.cell_ids(), mesh.cell_global, counts, start);
}

std::vector<GlobalId> node_offsets(const par::Comm& comm, const DistMesh& mesh, std::span<const std::uint8_t> counts,
                                   GlobalId start) {
  return accumulate_by_number(comm, mesh.info.node_ids(), mesh.node_global, counts, start);
}

}  // namespace pamr::mesh
