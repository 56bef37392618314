// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/curved/straighten.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numeric>
#include <span>
#include <string>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/quadratic_tet.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::curved {

namespace {

geometry::Vec3 place(const refine::Movable& m, std::uint8_t step) {
  if (step == 0) return m.target;
  if (step >= not_at_all) return m.base;
  return m.base + std::ldexp(1.0, -static_cast<int>(step)) * (m.target - m.base);
}

class Straightener {
 public:
  Straightener(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<refine::Movable>& movables,
               const par::Pattern& shared, const Options& options, mesh::SecondOrder& nodes)
      : comm_(comm),
        mesh_(mesh),
        movables_(movables),
        exchange_(comm, shared),
        options_(options),
        nodes_(nodes),
        step_(movables.size(), 0),
        movable_of_(nodes.node_position.size(), -1),
        share_(at(mesh.n_cells()), 1.0),
        is_cut_(at(mesh.n_cells()), 0),
        has_asked_(at(mesh.n_cells()), 0) {
    for (std::size_t i = 0; i < movables.size(); ++i) movable_of_[at(movables[i].node)] = static_cast<LocalId>(i);
  }

  Straightened run() {
    std::vector<LocalId> cells(at(mesh_.n_cells()));
    std::iota(cells.begin(), cells.end(), 0);
    int rounds = 0;
    for (auto changed = take_back_once(cells); !changed.empty(); ++rounds) {
      changed = max_over_ranks(std::move(changed));
      cells = move(changed);
      changed = take_back_once(cells);
    }
    return {step_, report(rounds)};
  }

 private:
  bool is_curved(LocalId movable) const {
    if (movable < 0) return false;
    const auto& m = movables_[at(movable)];
    return !(nodes_.node_position[at(m.node)] == m.base);
  }

  /// The movables of the curved edges of a cell, -1 for its other edges.
  std::array<LocalId, 6> curved_edges(LocalId cell) const {
    std::array<LocalId, 6> edges{};
    for (std::size_t e = 0; e < 6; ++e) {
      const auto i = movable_of_[at(nodes_.cell_to_mid[at(cell)][e])];
      edges[e] = is_curved(i) ? i : -1;
    }
    return edges;
  }

  bool is_proved(LocalId cell, bool is_curved) {
    const auto tet = mesh::quadratic_tet(mesh_, nodes_, cell);
    const double straight = 6 * geometry::volume(mesh_.points(cell));
    const auto bound = geometry::bound_jacobian(tet, is_curved ? options_.min_jacobian * straight : 0);
    if (!bound.is_proved) return !is_curved && geometry::is_positive_exactly(tet);
    is_cut_[at(cell)] = bound.n_pieces > 1 ? 1 : 0;
    share_[at(cell)] = is_curved ? std::min(1.0, bound.lower / straight) : 1.0;
    return true;
  }

  /// Steps that these cells ask for, of every movable; empty on every rank if none of any rank asks. Collective.
  std::vector<std::uint8_t> take_back_once(std::span<const LocalId> cells) {
    auto wanted = step_;
    bool asks = false;
    std::string trouble;
    for (const auto c : cells) {
      const auto edges = curved_edges(c);
      const bool has_curved = std::any_of(edges.begin(), edges.end(), [](LocalId i) { return i >= 0; });
      if (is_proved(c, has_curved)) continue;
      if (!has_curved && trouble.empty())
        trouble = fmt::format(
            "second order: expected cells that stay positive with nodes in the middle of their edges, found cell {} "
            "so flat that rounding inverts it",
            mesh_.cell_global[at(c)]);
      has_asked_[at(c)] = 1;
      asks = true;
      for (const auto i : edges)
        if (i >= 0) wanted[at(i)] = static_cast<std::uint8_t>(step_[at(i)] + 1);
    }
    par::agree(comm_, [&] {
      if (!trouble.empty()) throw Error(trouble);
    });
    if (!comm_.any(asks)) return {};
    wanted.push_back(0);  // never empty: the other ranks go on
    return wanted;
  }

  /// For each movable the largest of the steps that the ranks want.
  std::vector<std::uint8_t> max_over_ranks(std::vector<std::uint8_t> wanted) const {
    const auto step_of = [&](LocalId node) {
      const auto i = movable_of_[at(node)];
      return i < 0 ? std::uint8_t{0} : wanted[at(i)];
    };
    par::fold_shared(exchange_, step_of, [&](LocalId node, std::uint8_t theirs) {
      if (const auto i = movable_of_[at(node)]; i >= 0) wanted[at(i)] = std::max(wanted[at(i)], theirs);
    });
    return wanted;
  }

  /// Moves the nodes and returns the cells that have one which moved.
  std::vector<LocalId> move(const std::vector<std::uint8_t>& wanted) {
    std::vector<std::uint8_t> has_moved(movables_.size(), 0);
    for (std::size_t i = 0; i < step_.size(); ++i) {
      if (wanted[i] == step_[i]) continue;
      step_[i] = wanted[i];
      has_moved[i] = 1;
      nodes_.node_position[at(movables_[i].node)] = place(movables_[i], step_[i]);
    }
    std::vector<LocalId> cells;
    for (LocalId c = 0; c < mesh_.n_cells(); ++c) {
      const auto& mid = nodes_.cell_to_mid[at(c)];
      if (std::any_of(mid.begin(), mid.end(), [&](LocalId node) {
            const auto i = movable_of_[at(node)];
            return i >= 0 && has_moved[at(i)] != 0;
          }))
        cells.push_back(c);
    }
    return cells;
  }

  /// Collective: two reductions.
  Straightening report(int rounds) const {
    const auto is_mine = par::held_first_here(exchange_, nodes_.node_position.size());
    std::array<std::int64_t, 3> sum{0, std::count(has_asked_.begin(), has_asked_.end(), 1),
                                    std::count(is_cut_.begin(), is_cut_.end(), 1)};
    for (std::size_t i = 0; i < step_.size(); ++i)
      if (step_[i] > 0) sum[0] += is_mine[at(movables_[i].node)];
    comm_.sum_in_place(sum);
    double share = 1;
    for (const auto s : share_) share = std::min(share, s);
    return {sum[0], sum[1], sum[2], comm_.min(share), rounds};
  }

  const par::Comm& comm_;
  const mesh::DistMesh& mesh_;
  const std::vector<refine::Movable>& movables_;
  par::Exchange exchange_;
  const Options& options_;
  mesh::SecondOrder& nodes_;
  std::vector<std::uint8_t> step_;       ///< of each movable
  std::vector<LocalId> movable_of_;      ///< of each node, -1: none
  std::vector<double> share_;            ///< of each cell: proved share of the straight cell's Jacobian
  std::vector<std::uint8_t> is_cut_;     ///< cells whose proof took several pieces
  std::vector<std::uint8_t> has_asked_;  ///< cells that were not proved in some round
};

}  // namespace

Straightened straighten(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<refine::Movable>& movables,
                        const par::Pattern& shared, const Options& options, mesh::SecondOrder& nodes) {
  return Straightener(comm, mesh, movables, shared, options, nodes).run();
}

}  // namespace pamr::curved
