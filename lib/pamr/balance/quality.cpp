// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/quality.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pamr/base/contract.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/ghost_values.hpp"

namespace pamr::balance {

namespace {

/// Faces around a compact part of n cells, over n^(2/3): the geometric mean over Scotch's 2 to 64 parts of five meshes
/// (`bench/balance.sh --constant`). Cubes of Kuhn's tetrahedra have 12 / 6^(2/3) = 3.63.
constexpr double faces_of_compact_part = 3.4;
/// A body cannot be cut into two or three parts as compact as itself: with this the halves of a cube come out right.
constexpr double more_of_few_parts = 0.57;

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
  const auto beyond = mesh::ghost_values(comm, mesh, part);
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

/// All but the neighbors. Collective.
template <class Visit>
Quality measure(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight,
                std::span<const Rank> part, Rank n_parts, Visit visit) {
  PAMR_EXPECTS(part.size() == at(mesh.n_cells()) && weight.size() == part.size());
  Quality quality;
  quality.edge_cut = for_each_cut_face(comm, mesh, part, visit);
  const auto n = at(n_parts);
  std::vector<std::int64_t> sum(2 * n, 0);  // weights of the parts, then their cells
  for (std::size_t c = 0; c < part.size(); ++c) {
    sum[at(part[c])] += weight[c];
    ++sum[n + at(part[c])];
  }
  comm.sum_in_place(sum);
  const auto part_weight = std::span<const std::int64_t>(sum).first(n),
             cells = std::span<const std::int64_t>(sum).last(n);
  quality.imbalance = imbalance_of(part_weight);
  quality.compact_cut = faces_between_compact_parts(cells);
  quality.empty_parts = std::count(part_weight.begin(), part_weight.end(), 0);
  return quality;
}

}  // namespace

double faces_between_compact_parts(std::span<const std::int64_t> cells_of_part) {
  const auto around = [](std::int64_t n) {
    return faces_of_compact_part * std::pow(static_cast<double>(n), 2.0 / 3.0);
  };
  const auto body = around(std::accumulate(cells_of_part.begin(), cells_of_part.end(), std::int64_t{0}));
  if (body == 0) return 0;
  double sides = 0;
  for (const auto n : cells_of_part) sides += around(n);
  const double n_like_parts = std::pow(sides / body, 3.0);  // so many equal ones have as many faces
  return 0.5 * (sides - body) * (1 + more_of_few_parts / n_like_parts);
}

double imbalance_of(std::span<const std::int64_t> part_weight) {
  const auto total = std::accumulate(part_weight.begin(), part_weight.end(), std::int64_t{0});
  const auto greatest = *std::max_element(part_weight.begin(), part_weight.end());
  return total == 0
             ? 1
             : static_cast<double>(greatest) * static_cast<double>(part_weight.size()) / static_cast<double>(total);
}

Quality measure_cut(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight,
                    std::span<const Rank> part, Exact<Rank> n_parts) {
  return measure(comm, mesh, weight, part, n_parts, [](PartPair) {});
}

Quality measure(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight,
                std::span<const Rank> part, Exact<Rank> n_parts) {
  std::vector<PartPair> pairs;
  auto quality = measure(comm, mesh, weight, part, n_parts, [&](PartPair pair) {
    if (pairs.empty() || pairs.back() != pair) pairs.push_back(pair);
  });
  count_neighbors(comm, std::move(pairs), n_parts, quality);
  return quality;
}

Quality measure_ranks(const par::Comm& comm, const mesh::DistMesh& mesh, Exact<std::int64_t> weight_here) {
  const auto of_rank = comm.all_gather(weight_here);
  const auto n_neighbors = static_cast<std::int64_t>(mesh.border_rank.size());
  Quality quality;
  quality.imbalance = imbalance_of(of_rank);
  quality.edge_cut = comm.sum(static_cast<std::int64_t>(mesh.border_face.size())) / 2;
  quality.compact_cut = faces_between_compact_parts(comm.all_gather(static_cast<std::int64_t>(mesh.n_cells())));
  quality.max_neighbors = comm.max(n_neighbors);
  quality.mean_neighbors = static_cast<double>(comm.sum(n_neighbors)) / static_cast<double>(comm.size());
  quality.empty_parts = std::count(of_rank.begin(), of_rank.end(), 0);
  return quality;
}

}  // namespace pamr::balance
