// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::poisson_boltzmann {

/// Which rank owns which node, and the equations, numbered rank by rank, on a rank in the order of its local nodes.
/// Nodes that two ranks hold are divided into halves by their global numbers: the lower rank owns the first half. A
/// node that more hold belongs to one of them by its number. So no rank owns all of its border, whatever its place
/// among the ranks, and half a border is a piece of it where the numbers follow the places.
class NodeMap {
 public:
  /// Collective: finds the shared nodes, one exchange. Throws `Error` when the mesh has more nodes than 31 bits count.
  NodeMap(const par::Comm& comm, const mesh::DistMesh& mesh);
  /// The same for nodes of which the shared ones are known: `node_global` are the numbers of those here, of
  /// `n_global_nodes` in all. Collective: one exchange.
  NodeMap(const par::Comm& comm, par::Pattern shared, std::span<const GlobalId> node_global, GlobalId n_global_nodes);
  /// The same for `n_nodes` things here that have no global numbers: the lowest rank that holds one owns it.
  /// Collective: one exchange.
  NodeMap(const par::Comm& comm, par::Pattern shared, std::size_t n_nodes, GlobalId n_global_nodes);

  std::size_t n_nodes() const { return equation_.size(); }
  std::size_t n_owned() const { return owned_.size(); }
  std::int32_t first_equation() const { return first_; }
  std::int32_t n_equations() const { return n_equations_; }
  /// Local nodes that this rank owns, ascending; entry k has equation `first_equation() + k`.
  const std::vector<LocalId>& owned() const { return owned_; }
  /// Equation of each local node.
  const std::vector<std::int32_t>& equation() const { return equation_; }
  bool is_owned(std::size_t node) const {
    return equation_[node] >= first_ && equation_[node] < first_ + static_cast<std::int32_t>(owned_.size());
  }
  const par::Pattern& shared() const { return shared_; }

  /// Values of all local nodes from those of the owned ones. Collective: one exchange.
  std::vector<double> spread(const par::Comm& comm, std::span<const double> owned) const;
  /// Values of the owned nodes in the order of `owned`. Local.
  std::vector<double> owned_values(std::span<const double> local) const;
  /// What the copies of a node hold on all ranks, joined with `join(a, b)` in the order of the ranks, so that every
  /// copy gets the same bits. Collective: one exchange.
  template <class T, class Join>
  void join_copies(const par::Comm& comm, std::vector<T>& local, Join&& join) const;
  /// Sums of the copies. Collective: one exchange.
  void sum_copies(const par::Comm& comm, std::vector<double>& local) const;
  /// The same for vectors. Collective: one exchange.
  void sum_copies(const par::Comm& comm, std::vector<geometry::Vec3>& local) const;

 private:
  void number(const par::Comm& comm, const std::vector<std::uint8_t>& is_elsewhere, GlobalId n_global_nodes);

  std::vector<LocalId> owned_;
  std::vector<std::int32_t> equation_;
  std::int32_t first_ = 0, n_equations_ = 0;
  par::Pattern shared_;
};

template <class T, class Join>
void NodeMap::join_copies(const par::Comm& comm, std::vector<T>& local, Join&& join) const {
  const par::Exchange exchange(comm, shared_);
  std::vector<T> mine(shared_.item.size());
  for (std::size_t k = 0; k < mine.size(); ++k) mine[k] = local[at(shared_.item[k])];
  const auto theirs = exchange.template swap<T>(mine);
  std::vector<std::uint8_t> seen(local.size(), 0);
  std::vector<T> below(local.size());
  for (std::size_t i = 0; i < shared_.rank.size(); ++i) {
    const bool is_lower = shared_.rank[i] < comm.rank();
    for (std::size_t k = shared_.offset[i]; k < shared_.offset[i + 1]; ++k) {
      const auto node = at(shared_.item[k]);
      if (is_lower) {
        below[node] = seen[node] != 0 ? join(below[node], theirs[k]) : theirs[k];
        seen[node] = 1;
      }
    }
  }
  for (std::size_t node = 0; node < local.size(); ++node)
    if (seen[node] != 0) local[node] = join(below[node], local[node]);
  for (std::size_t i = 0; i < shared_.rank.size(); ++i)
    if (shared_.rank[i] > comm.rank())
      for (std::size_t k = shared_.offset[i]; k < shared_.offset[i + 1]; ++k) {
        const auto node = at(shared_.item[k]);
        local[node] = join(local[node], theirs[k]);
      }
}

}  // namespace pamr::poisson_boltzmann
