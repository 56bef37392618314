// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/fem/node_map.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::poisson_boltzmann {

namespace {

/// Which of the nodes here this rank owns.
std::vector<std::uint8_t> owned_here(Rank here, const par::Pattern& shared, std::span<const GlobalId> node_global) {
  std::vector<std::int32_t> n_others(node_global.size(), 0), n_lower(node_global.size(), 0);
  for (std::size_t i = 0; i < shared.rank.size(); ++i)
    for (std::size_t k = shared.offset[i]; k < shared.offset[i + 1]; ++k) {
      ++n_others[at(shared.item[k])];
      if (shared.rank[i] < here) ++n_lower[at(shared.item[k])];
    }
  std::vector<std::uint8_t> result(node_global.size(), 1);
  std::vector<LocalId> pair;
  for (std::size_t i = 0; i < shared.rank.size(); ++i) {
    pair.clear();
    for (std::size_t k = shared.offset[i]; k < shared.offset[i + 1]; ++k) {
      const auto node = at(shared.item[k]);
      if (n_others[node] == 1)
        pair.push_back(shared.item[k]);
      else
        result[node] = node_global[node] % (n_others[node] + 1) == n_lower[node];
    }
    std::sort(pair.begin(), pair.end(), [&](LocalId a, LocalId b) { return node_global[at(a)] < node_global[at(b)]; });
    const auto half = (pair.size() + 1) / 2;
    const bool is_lower = here < shared.rank[i];
    for (std::size_t k = 0; k < pair.size(); ++k) result[at(pair[k])] = (k < half) == is_lower;
  }
  return result;
}

}  // namespace

NodeMap::NodeMap(const par::Comm& comm, const mesh::DistMesh& mesh)
    : NodeMap(comm, mesh::find_borders(comm, mesh).nodes, mesh.node_global, mesh.info.n_global_nodes) {}

NodeMap::NodeMap(const par::Comm& comm, par::Pattern shared, std::span<const GlobalId> node_global,
                 GlobalId n_global_nodes)
    : shared_(std::move(shared)) {
  number(comm, owned_here(comm.rank(), shared_, node_global), n_global_nodes);
}

NodeMap::NodeMap(const par::Comm& comm, par::Pattern shared, std::size_t n_nodes, GlobalId n_global_nodes)
    : shared_(std::move(shared)) {
  number(comm, par::held_first_here(par::Exchange(comm, shared_), n_nodes), n_global_nodes);
}

void NodeMap::number(const par::Comm& comm, const std::vector<std::uint8_t>& is_mine, GlobalId n_global_nodes) {
  if (n_global_nodes > std::numeric_limits<std::int32_t>::max())
    throw Error(fmt::format("expected a mesh of at most 2147483647 nodes, found {}", n_global_nodes));
  const auto n_nodes = is_mine.size();
  for (std::size_t node = 0; node < n_nodes; ++node)
    if (is_mine[node] != 0) owned_.push_back(static_cast<LocalId>(node));

  const auto n_owned = static_cast<std::int64_t>(owned_.size());
  first_ = static_cast<std::int32_t>(comm.exclusive_sum(n_owned));
  n_equations_ = static_cast<std::int32_t>(comm.sum(n_owned));
  equation_.assign(n_nodes, std::numeric_limits<std::int32_t>::max());
  for (std::size_t k = 0; k < owned_.size(); ++k) equation_[at(owned_[k])] = first_ + static_cast<std::int32_t>(k);
  // Every copy learns the owner's number: the others hold the largest there is.
  par::fold_shared(par::Exchange(comm, shared_), equation_,
                   [](std::int32_t& mine, std::int32_t theirs) { mine = std::min(mine, theirs); });
}

std::vector<double> NodeMap::spread(const par::Comm& comm, std::span<const double> owned) const {
  std::vector<double> local(n_nodes(), 0);
  for (std::size_t k = 0; k < owned_.size(); ++k) local[at(owned_[k])] = owned[k];
  sum_copies(comm, local);
  return local;
}

std::vector<double> NodeMap::owned_values(std::span<const double> local) const {
  std::vector<double> result(owned_.size());
  for (std::size_t k = 0; k < owned_.size(); ++k) result[k] = local[at(owned_[k])];
  return result;
}

void NodeMap::sum_copies(const par::Comm& comm, std::vector<double>& local) const {
  if (comm.size() == 1) return;
  par::fold_in_rank_order(par::Exchange(comm, shared_), local, [](double a, double b) { return a + b; });
}

void NodeMap::sum_copies(const par::Comm& comm, std::vector<geometry::Vec3>& local) const {
  if (comm.size() == 1) return;
  par::fold_in_rank_order(par::Exchange(comm, shared_), local,
                          [](geometry::Vec3 a, geometry::Vec3 b) { return a + b; });
}

}  // namespace pamr::poisson_boltzmann
