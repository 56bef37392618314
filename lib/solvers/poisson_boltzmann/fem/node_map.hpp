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
  /// Sums of the copies. Collective: one exchange.
  void sum_copies(const par::Comm& comm, std::vector<double>& local) const;
  /// The same for vectors. Collective: one exchange.
  void sum_copies(const par::Comm& comm, std::vector<geometry::Vec3>& local) const;

 private:
  void number(const par::Comm& comm, const std::vector<std::uint8_t>& is_mine, GlobalId n_global_nodes);

  std::vector<LocalId> owned_;
  std::vector<std::int32_t> equation_;
  std::int32_t first_ = 0, n_equations_ = 0;
  par::Pattern shared_;
};

}  // namespace pamr::poisson_boltzmann
