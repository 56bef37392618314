// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/partition.hpp"

#include <algorithm>
#include <numeric>
#include <optional>
#include <utility>

#include "pamr/balance/dual_graph.hpp"
#include "pamr/balance/parts_along_curve.hpp"
#include "pamr/balance/price.hpp"
#include "pamr/balance/scotch_partition.hpp"
#include "pamr/balance/smooth_parts.hpp"
#include "pamr/balance/weighted_blocks.hpp"
#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/cell_runs.hpp"

namespace pamr::balance {

namespace {

/// Scotch wants something to choose from: below so many vertices a part, runs of cells do as well.
constexpr std::int64_t min_vertices_per_part = 8;

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

/// Parts, and what made them.
struct Choice {
  std::vector<Rank> part;
  Method method = Method::none;
  Quality quality;  ///< without neighbors
};

/// Parts by Scotch, or none on every rank where there are too few vertices, or no Scotch.
std::optional<std::vector<Rank>> part_by_scotch(const par::Comm& comm, const mesh::DistMesh& mesh,
                                                std::span<const std::int64_t> weight, Rank n_parts,
                                                const Options& options) {
  if (!has_scotch()) return {};
  const auto total = comm.sum(std::accumulate(weight.begin(), weight.end(), std::int64_t{0}));
  const auto n_wanted = options.vertices_per_part * n_parts;
  // all cells where they are few anyway
  const bool is_fine = n_wanted == 0 || mesh.info.n_global_cells <= 2 * n_wanted;
  const auto groups =
      is_fine ? group_families(mesh) : group_by_weight(mesh, weight, std::max<std::int64_t>(1, total / n_wanted));
  const auto graph = build_dual_graph(comm, mesh, groups, weight);
  if (graph.n_global_vertices < min_vertices_per_part * n_parts) return {};
  const auto of_vertex = scotch_partition(comm, graph, n_parts, options.tolerance);
  std::vector<Rank> part(weight.size());
  for (std::size_t v = 0; v < groups.size(); ++v)
    for (const auto cell : groups.cells(v)) part[at(cell)] = of_vertex[v];
  smooth_parts(comm, mesh, weight, {.n_parts = n_parts, .max_imbalance = 1 + options.tolerance}, part);
  return part;
}

/// Whether the cells of a rank lie so far from one another that groups of them would not be compact.
bool are_scattered(const Quality& of_ranks) {
  return static_cast<double>(of_ranks.edge_cut) > 4 * of_ranks.compact_cut;
}

/// Makes and compares parts of one mesh.
class Chooser {
 public:
  Chooser(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight, Rank n_parts,
          const Options& options)
      : comm_(comm), mesh_(mesh), weight_(weight), n_parts_(n_parts), options_(options) {}

  Choice choose() const {
    switch (options_.method) {
      case Method::best:
        return cheapest();
      case Method::scotch:
        return scotch();
      case Method::curve:
        return curve();
      default:
        return blocks();
    }
  }

 private:
  Choice measured(std::vector<Rank> part, Method method) const {
    auto quality = measure_cut(comm_, mesh_, weight_, part, n_parts_);
    return {std::move(part), method, quality};
  }
  Choice blocks() const { return measured(weighted_blocks(comm_, mesh_, weight_, n_parts_), Method::blocks); }
  Choice curve() const { return measured(parts_along_curve(comm_, mesh_, weight_, n_parts_), Method::curve); }

  /// The better one for who works with the parts.
  Choice better(Choice a, Choice b) const {
    const bool a_meets = meets(a.quality, options_), b_meets = meets(b.quality, options_);
    if (a_meets != b_meets) return a_meets ? std::move(a) : std::move(b);
    return work_of_pass(b.quality, size()) < work_of_pass(a.quality, size()) ? std::move(b) : std::move(a);
  }

  bool are_even(const Choice& choice) const { return choice.quality.imbalance <= options_.keep_below; }

  /// What costs least where the ranks hold runs of cells: runs; else pieces of the curve. The other one where these are
  /// not good enough: runs that the ranks do not hold only where many cells share a place on the curve.
  Choice without_scotch() const {
    if (mesh::cell_runs(comm_, mesh_).empty()) {
      auto pieces = curve();
      return are_even(pieces) ? std::move(pieces) : better(blocks(), std::move(pieces));
    }
    auto runs = blocks();
    return meets(runs.quality, options_) ? std::move(runs) : better(std::move(runs), curve());
  }

  /// Scotch's parts; pieces of the curve where Scotch cannot make any, or where these meet what its own miss.
  Choice scotch() const {
    auto part = part_by_scotch(comm_, mesh_, weight_, n_parts_, options_);
    if (!part) return curve();
    auto result = measured(std::move(*part), Method::scotch);
    auto accepted = options_;
    accepted.keep_below = std::max(accepted.keep_below, options_.worst_accepted);
    return meets(result.quality, accepted) ? std::move(result) : better(std::move(result), curve());
  }

  Choice cheapest() const {
    auto cheap = without_scotch();
    if (are_even(cheap) && options_.passes * work_of_pass(cheap.quality, size()) <= work_with_scotch(size(), options_))
      return cheap;
    auto part = part_by_scotch(comm_, mesh_, weight_, n_parts_, options_);
    if (!part) return cheap;
    return better(std::move(cheap), measured(std::move(*part), Method::scotch));
  }

  Size size() const { return {mesh_.info.n_global_cells, n_parts_}; }

  const par::Comm& comm_;
  const mesh::DistMesh& mesh_;
  std::span<const std::int64_t> weight_;
  Rank n_parts_;
  const Options& options_;
};

/// Greatest weight of a family or another cell over the mean of a part, which no part can be below. Collective.
double heaviest_family(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight,
                       Rank n_parts) {
  std::int64_t most = 0, family = 0, total = 0;
  for (std::size_t c = 0; c < weight.size(); ++c) {
    const auto lineage = mesh.lineage[c];
    family = lineage.is_removable() && lineage.child() > 0 ? family + weight[c] : weight[c];
    most = std::max(most, family);
    total += weight[c];
  }
  total = comm.sum(total);
  return total == 0 ? 0 : static_cast<double>(comm.max(most)) * n_parts / static_cast<double>(total);
}

}  // namespace

Method method_named(std::string_view wanted) {
  for (const auto& [name, method] : method_names)
    if (wanted == name) return method;
  throw Error("balance: expected auto, scotch, curve, blocks or none, found " + std::string(wanted));
}

const char* name_of(Method method) {
  for (const auto& [name, value] : method_names)
    if (value == method) return name;
  return "";
}

std::string what_stands_in(Method method) {
  if (method != Method::scotch || has_scotch()) return {};
  return "this build has no PT-Scotch: parts are pieces of a space-filling curve";
}

Partition partition(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight,
                    Exact<Rank> n_parts, const Options& options) {
  PAMR_EXPECTS(weight.size() == at(mesh.n_cells()) && n_parts >= 1);
  const bool are_ranks = n_parts == comm.size(), may_stay = are_ranks && options.keep_below >= 1;
  Partition result;
  const auto keep = [&] {
    result.part.assign(weight.size(), comm.rank());
    return std::move(result);
  };
  if (are_ranks)
    result.quality = measure_ranks(comm, mesh, std::accumulate(weight.begin(), weight.end(), std::int64_t{0}));
  if (are_ranks && options.method == Method::none) return keep();
  if (may_stay && meets(result.quality, options)) return keep();
  auto asked = options;
  asked.keep_below = std::max(options.keep_below < 1 ? options.worst_accepted : options.keep_below,
                              heaviest_family(comm, mesh, weight, n_parts));
  if (may_stay && meets(result.quality, asked)) return keep();
  if (are_ranks && are_scattered(result.quality)) asked.vertices_per_part = 0;
  if (n_parts == 1) {
    result.part.assign(weight.size(), 0);
  } else {
    auto choice = Chooser(comm, mesh, weight, n_parts, asked).choose();
    if (may_stay && !is_gain(result.quality, choice.quality, {mesh.info.n_global_cells, n_parts}, asked)) return keep();
    result.part = std::move(choice.part);
    result.method = choice.method;
    if (are_ranks) {
      const auto name = name_parts(comm, weight, result.part);
      for (auto& part : result.part) part = name[at(part)];
    }
  }
  result.quality = measure(comm, mesh, weight, result.part, n_parts);
  return result;
}

}  // namespace pamr::balance
