// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/partition.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pamr/balance/dual_graph.hpp"
#include "pamr/balance/scotch_partition.hpp"
#include "pamr/balance/smooth_parts.hpp"
#include "pamr/balance/weighted_blocks.hpp"
#include "pamr/balance/weights.hpp"
#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"

namespace pamr::balance {

namespace {

/// Scotch wants something to choose from: below so many vertices a part, runs of cells do as well.
constexpr std::int64_t min_vertices_per_part = 8;

struct PartPair {
  Rank of = 0;
  Rank neighbor = 0;
  friend auto operator<=>(const PartPair&, const PartPair&) = default;
};

void sort_and_unique(std::vector<PartPair>& pairs) {
  std::sort(pairs.begin(), pairs.end());
  pairs.erase(std::unique(pairs.begin(), pairs.end()), pairs.end());
}

/// Calls `visit` for this rank's side of every face between parts; returns their number on all ranks. Collective.
template <class Visit>
std::int64_t for_each_cut_face(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const Rank> part,
                               Visit visit) {
  const auto beyond = swap_over_faces<Rank>(comm, mesh, part);
  std::int64_t n_sides = 0;
  for (std::size_t c = 0; c < part.size(); ++c)
    for (const auto neighbor : mesh.cell_to_cell[c]) {
      if (neighbor < 0) continue;
      const auto other = mesh.is_ghost(neighbor) ? beyond[at(neighbor - mesh.n_cells())] : part[at(neighbor)];
      if (other == part[c]) continue;
      ++n_sides;
      visit(PartPair{part[c], other});
    }
  return comm.sum(n_sides) / 2;
}

/// Counts the neighbors of the parts from the pairs that each rank sees. Collective.
void count_neighbors(const par::Comm& comm, std::vector<PartPair> pairs, Rank n_parts, Quality& quality) {
  sort_and_unique(pairs);
  std::vector<par::Outgoing<PartPair>> messages;
  for (const auto& pair : pairs) {
    const auto to = par::block_of(pair.of, n_parts, comm.size());
    if (messages.empty() || messages.back().to != to) messages.push_back({to, {}});
    messages.back().item.push_back(pair);
  }
  pairs = comm.sparse_exchange(messages).item;
  sort_and_unique(pairs);
  std::int64_t most = 0, run = 0;
  for (std::size_t i = 0; i < pairs.size(); ++i) {
    run = i > 0 && pairs[i].of == pairs[i - 1].of ? run + 1 : 1;
    most = std::max(most, run);
  }
  quality.max_neighbors = comm.max(most);
  quality.mean_neighbors =
      static_cast<double>(comm.sum(static_cast<std::int64_t>(pairs.size()))) / static_cast<double>(n_parts);
}

std::vector<std::int64_t> weigh(const par::Comm& comm, std::span<const std::int64_t> weight, std::span<const Rank> part,
                                Rank n_parts) {
  std::vector<std::int64_t> sum(at(n_parts), 0);
  for (std::size_t c = 0; c < part.size(); ++c) sum[at(part[c])] += weight[c];
  comm.sum_in_place(sum);
  return sum;
}

double imbalance_of(std::span<const std::int64_t> part_weight) {
  const auto total = std::accumulate(part_weight.begin(), part_weight.end(), std::int64_t{0});
  const auto greatest = *std::max_element(part_weight.begin(), part_weight.end());
  return total == 0
             ? 1
             : static_cast<double>(greatest) * static_cast<double>(part_weight.size()) / static_cast<double>(total);
}

/// What a rank holds of a part.
struct Holding {
  std::int64_t weight = 0;
  Rank part = 0;
  Rank rank = 0;
};

/// Number of the rank that each part shall bear: the greatest holdings choose first. Collective: each rank tells rank 0
/// of the parts it holds cells of, at most `n` each.
std::vector<Rank> name_parts(const par::Comm& comm, std::span<const std::int64_t> weight, std::span<const Rank> part) {
  const auto n = at(comm.size());
  std::vector<std::int64_t> here(n, 0);
  for (std::size_t c = 0; c < part.size(); ++c) here[at(part[c])] += weight[c];
  std::vector<par::Outgoing<Holding>> message{{0, {}}};
  for (std::size_t p = 0; p < n; ++p)
    if (here[p] > 0) message[0].item.push_back({here[p], static_cast<Rank>(p), comm.rank()});
  auto holdings = comm.sparse_exchange(message).item;
  std::sort(holdings.begin(), holdings.end(), [](const Holding& a, const Holding& b) {
    if (a.weight != b.weight) return a.weight > b.weight;
    return a.part != b.part ? a.part < b.part : a.rank < b.rank;
  });
  std::vector<Rank> name(n, -1);
  std::vector<std::uint8_t> is_taken(n, 0);
  for (const auto& holding : holdings)
    if (name[at(holding.part)] < 0 && is_taken[at(holding.rank)] == 0) {
      name[at(holding.part)] = holding.rank;
      is_taken[at(holding.rank)] = 1;
    }
  Rank next = 0;
  for (auto& rank : name) {
    if (rank >= 0) continue;
    while (is_taken[at(next)] != 0) ++next;
    rank = next++;
  }
  return comm.broadcast(std::move(name), 0);
}

/// Parts by Scotch, or nothing on every rank where there are too few vertices.
std::vector<Rank> part_by_scotch(const par::Comm& comm, const mesh::DistMesh& mesh,
                                 std::span<const std::int64_t> weight, Rank n_parts, const Options& options,
                                 bool& is_done) {
  const auto total = comm.sum(std::accumulate(weight.begin(), weight.end(), std::int64_t{0}));
  const auto n_wanted = options.vertices_per_part * n_parts;
  // all cells where they are few anyway
  const bool is_fine = n_wanted == 0 || mesh.info.n_global_cells <= 2 * n_wanted;
  const auto groups =
      is_fine ? group_families(mesh) : group_by_weight(mesh, weight, std::max<std::int64_t>(1, total / n_wanted));
  const auto graph = build_dual_graph(comm, mesh, groups, weight);
  is_done = graph.n_global_vertices >= min_vertices_per_part * n_parts;
  if (!is_done) return {};
  const auto of_vertex = scotch_partition(comm, graph, n_parts, options.tolerance);
  std::vector<Rank> part(weight.size());
  for (std::size_t v = 0; v < groups.size(); ++v)
    for (const auto cell : groups.cells(v)) part[at(cell)] = of_vertex[v];
  smooth_parts(comm, mesh, weight, {.n_parts = n_parts, .max_imbalance = 1 + options.tolerance}, part);
  return part;
}

/// Faces between `n_parts` compact parts of so many cells. Cubes of 6 m^3 equal tetrahedra have 12 m^2 faces outside,
/// each shared by two parts.
double faces_between_compact_parts(GlobalId n_cells, Rank n_parts) {
  const auto in_part = static_cast<double>(n_cells) / static_cast<double>(n_parts);
  return 0.5 * static_cast<double>(n_parts) * 12 * std::pow(in_part / 6, 2.0 / 3.0);
}

/// Parts by the method asked for; `result.method` says what gave them.
void choose_parts(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight, Rank n_parts,
                  const Options& options, Partition& result) {
  std::vector<Rank> runs;
  const bool has_runs = options.method != Method::scotch;
  if (has_runs) {
    runs = weighted_blocks(comm, mesh, weight, n_parts);
    const auto accepted = options.runs_accepted * faces_between_compact_parts(mesh.info.n_global_cells, n_parts);
    if (options.method != Method::best ||
        static_cast<double>(for_each_cut_face(comm, mesh, runs, [](PartPair) {})) <= accepted) {
      result.part = std::move(runs);
      result.method = Method::blocks;
      return;
    }
  }
  bool is_done = false;
  result.part = part_by_scotch(comm, mesh, weight, n_parts, options, is_done);
  result.method = Method::scotch;
  const double achieved = is_done ? imbalance_of(weigh(comm, weight, result.part, n_parts)) : 0;
  if (is_done && achieved <= options.worst_accepted) return;
  if (!has_runs) runs = weighted_blocks(comm, mesh, weight, n_parts);
  if (!is_done || imbalance_of(weigh(comm, weight, runs, n_parts)) < achieved) {
    result.part = std::move(runs);
    result.method = Method::blocks;
  }
}

}  // namespace

Method method_named(std::string_view wanted) {
  for (const auto& [name, method] : method_names)
    if (wanted == name) return method;
  throw Error("balance: expected auto, scotch, blocks or none, found " + std::string(wanted));
}

const char* name_of(Method method) {
  for (const auto& [name, value] : method_names)
    if (value == method) return name;
  return "";
}

Quality measure(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight,
                std::span<const Rank> part, Exact<Rank> n_parts) {
  PAMR_EXPECTS(part.size() == at(mesh.n_cells()) && weight.size() == part.size());
  Quality quality;
  std::vector<PartPair> pairs;
  quality.edge_cut = for_each_cut_face(comm, mesh, part, [&](PartPair pair) {
    if (pairs.empty() || pairs.back() != pair) pairs.push_back(pair);
  });
  count_neighbors(comm, std::move(pairs), n_parts, quality);
  const auto part_weight = weigh(comm, weight, part, n_parts);
  quality.imbalance = imbalance_of(part_weight);
  quality.empty_parts = std::count(part_weight.begin(), part_weight.end(), 0);
  return quality;
}

Quality measure_ranks(const par::Comm& comm, const mesh::DistMesh& mesh, Exact<std::int64_t> weight_here) {
  const auto of_rank = comm.all_gather(weight_here);
  const auto n_neighbors = static_cast<std::int64_t>(mesh.border_rank.size());
  Quality quality;
  quality.imbalance = imbalance_of(of_rank);
  quality.edge_cut = comm.sum(static_cast<std::int64_t>(mesh.border_face.size())) / 2;
  quality.max_neighbors = comm.max(n_neighbors);
  quality.mean_neighbors = static_cast<double>(comm.sum(n_neighbors)) / static_cast<double>(comm.size());
  quality.empty_parts = std::count(of_rank.begin(), of_rank.end(), 0);
  return quality;
}

Partition partition(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight,
                    Exact<Rank> n_parts, const Options& options) {
  PAMR_EXPECTS(weight.size() == at(mesh.n_cells()) && n_parts >= 1);
  Partition result;
  const bool are_ranks = n_parts == comm.size();
  if (are_ranks) {
    result.quality = measure_ranks(comm, mesh, std::accumulate(weight.begin(), weight.end(), std::int64_t{0}));
    if (options.method == Method::none || result.quality.imbalance <= options.keep_below) {
      result.part.assign(weight.size(), comm.rank());
      return result;
    }
  }
  if (n_parts == 1) {
    result.part.assign(weight.size(), 0);
  } else {
    choose_parts(comm, mesh, weight, n_parts, options, result);
    if (are_ranks) {
      const auto name = name_parts(comm, weight, result.part);
      for (auto& part : result.part) part = name[at(part)];
    }
  }
  result.quality = measure(comm, mesh, weight, result.part, n_parts);
  return result;
}

}  // namespace pamr::balance
