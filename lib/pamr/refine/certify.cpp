// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/certify.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/project.hpp"

namespace pamr::refine {

namespace {

using Positions = std::vector<geometry::Vec3>;
constexpr std::uint8_t not_at_all = 10;  ///< backing-off step at which a node stays where it was

geometry::Vec3 place(const Movable& m, std::uint8_t step) {
  if (step == 0) return m.target;
  if (step >= not_at_all) return m.base;
  return m.base + std::ldexp(1.0, -static_cast<int>(step)) * (m.target - m.base);
}

/// Cells of both lists, each once; `moved` ascends.
std::vector<LocalId> join(const std::vector<LocalId>& moved, const std::vector<LocalId>& suspects) {
  std::vector<LocalId> cells(moved);
  cells.insert(cells.end(), suspects.begin(), suspects.end());
  const auto middle = cells.begin() + static_cast<std::ptrdiff_t>(moved.size());
  std::sort(middle, cells.end());
  std::inplace_merge(cells.begin(), middle, cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

std::string describe(const NewLevel& level, LocalId cell) {
  return fmt::format(
      "refine: expected children of positive volume, found one that rounding inverts in the new cell {}: the cell "
      "it comes from is too flat to be split",
      level.children.cell_global[at(cell)]);
}

/// Takes the movement of the nodes back step by step.
class BackOff {
 public:
  BackOff(const par::Comm& comm, const NewLevel& level, Positions position, const std::vector<Movable>& movables,
          bool any_moves)
      : comm_(comm),
        exchange_(comm, level.shared),
        level_(level),
        movables_(movables),
        position_(std::move(position)),
        step_(movables_.size(), 0) {
    if (!any_moves) return;
    movable_of_.assign(level.n_nodes(), -1);
    for (std::size_t i = 0; i < movables_.size(); ++i) {
      movable_of_[at(movables_[i].node)] = static_cast<LocalId>(i);
      position_[at(movables_[i].node)] = movables_[i].target;
    }
  }

  /// How often the way of a movable was halved.
  std::uint8_t step(std::size_t movable) const { return step_[movable]; }
  Positions take_position() && { return std::move(position_); }
  geometry::Vec3 point(LocalId node) const { return position_[at(node)]; }

  /// One round; true when every rank found its cells positive.
  bool settle(std::span<const LocalId> cells) {
    std::vector<std::uint8_t> wanted = step_;
    bool all_positive = true;
    std::string trouble;
    for (const auto c : cells) {
      const auto p = level_.points(c, position_);
      if (geometry::is_positive(p[0], p[1], p[2], p[3])) continue;
      all_positive = false;
      bool can_yield = false;
      if (!movable_of_.empty())
        for (const auto node : level_.children.cell_to_node[at(c)]) {
          const auto i = movable_of_[at(node)];
          if (i < 0 || step_[at(i)] >= not_at_all) continue;
          can_yield = true;
          wanted[at(i)] = static_cast<std::uint8_t>(step_[at(i)] + 1);
        }
      if (!can_yield && trouble.empty()) trouble = describe(level_, c);
    }
    if (!comm_.any(!all_positive)) return true;
    par::agree(comm_, [&] {
      if (!trouble.empty()) throw Error(trouble);
    });
    take_back(max_over_ranks(std::move(wanted)));
    return false;
  }

 private:
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

  void take_back(const std::vector<std::uint8_t>& wanted) {
    for (std::size_t i = 0; i < step_.size(); ++i)
      if (wanted[i] != step_[i]) {
        step_[i] = wanted[i];
        position_[at(movables_[i].node)] = place(movables_[i], step_[i]);
      }
  }

  const par::Comm& comm_;
  par::Exchange exchange_;
  const NewLevel& level_;
  const std::vector<Movable>& movables_;
  Positions position_;
  std::vector<std::uint8_t> step_;   ///< of each movable
  std::vector<LocalId> movable_of_;  ///< of each node, -1: none; empty where nothing moves
};

/// Collective: one reduction.
Certificate make_certificate(const par::Comm& comm, const NewLevel& level, const std::vector<Movable>& movables,
                             const BackOff& back_off, std::size_t n_cells) {
  Certificate certificate;
  const auto is_mine = par::held_first_here(par::Exchange(comm, level.shared), level.n_nodes());
  std::int64_t n_off = 0, n_moved = 0, n_off_facets = 0;
  for (std::size_t i = 0; i < movables.size(); ++i) {
    const auto& m = movables[i];
    const auto point = back_off.point(m.node);
    if (!(point == m.base)) n_moved += is_mine[at(m.node)];
    if (m.off_facets > 0 && !(point == m.base)) {
      certificate.off_facets.push_back({m.node, std::ldexp(m.off_facets, -static_cast<int>(back_off.step(i)))});
      n_off_facets += is_mine[at(m.node)];
    }
    if (m.patch[0] < 0 || (back_off.step(i) == 0 && m.is_reachable)) continue;
    const auto on = surfaces_of_node(level.info, level.surfaces, m.patch);
    certificate.off_surface.push_back({m.node, geometry::distance_from_all(on.surface, point)});
    n_off += is_mine[at(m.node)];
  }
  const auto by_node = [](const OffSurface& a, const OffSurface& b) { return a.node < b.node; };
  std::sort(certificate.off_surface.begin(), certificate.off_surface.end(), by_node);
  std::sort(certificate.off_facets.begin(), certificate.off_facets.end(), by_node);
  std::array<std::int64_t, 4> sum{n_off, n_moved, static_cast<std::int64_t>(n_cells), n_off_facets};
  comm.sum_in_place(sum);
  certificate.n_off_surface = sum[0];
  certificate.n_moved = sum[1];
  certificate.n_cells_checked = sum[2];
  certificate.n_off_facets = sum[3];
  return certificate;
}

}  // namespace

Settled certify(const par::Comm& comm, const NewLevel& level, std::vector<geometry::Vec3> position,
                const std::vector<Movable>& movables) {
  const bool any_moves = comm.any(!movables.empty());
  BackOff back_off(comm, level, std::move(position), movables, any_moves);
  const auto cells = join(cells_with_moved_nodes(level, movables), level.children.suspects);
  int rounds = 0;
  while (!back_off.settle(cells)) ++rounds;
  Certificate certificate;
  if (any_moves) certificate = make_certificate(comm, level, movables, back_off, cells.size());
  certificate.back_off_rounds = rounds;
  return {std::move(back_off).take_position(), std::move(certificate)};
}

}  // namespace pamr::refine
