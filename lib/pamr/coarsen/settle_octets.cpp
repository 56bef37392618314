// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/coarsen/settle_octets.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <utility>

#include "pamr/base/memory.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/cell_shape.hpp"
#include "pamr/refine/diagonal.hpp"
#include "pamr/refine/family.hpp"
#include "pamr/refine/mapped_points.hpp"

namespace pamr::coarsen {

namespace {

using refine::all_edges;
using refine::EdgeMask;

/// A group on its way.
struct Open {
  Group group;
  EdgeMask marks = 0;      ///< those that were looked at last
  bool is_closed = false;  ///< stays as it is
  bool has_families = false;
};

class Settling {
 public:
  Settling(const mesh::DistMesh& mesh, const std::vector<Group>& octets, const Needs& needs)
      : mesh_(mesh), level0_(mesh), flags_(needs.flags), shape_floor_(needs.shape_floor) {
    assign_array(stays_, at(mesh.n_nodes()), std::uint8_t{0});
    for (const auto node : needs.nodes) stay(node);
    reserve_array(open_, at(mesh.n_cells()) / 2);  // groups have two cells or more
    start(octets);
    n_at_start_ = open_.size();
  }

  /// Applies the rules until nothing changes on this rank.
  void settle() {
    for (bool news = true; news;) {
      news = false;
      for (std::size_t i = 0; i < open_.size(); ++i)  // forced octets add families
        if (!open_[i].is_closed) news = apply_rules(i) || news;
    }
  }

  /// Keeps what would have an inverted cell, all of it as the nodes are now. True if there is any.
  bool keep_inverted() {
    std::vector<std::size_t> inverted;  // keeping one changes the nodes, which other ranks do not see yet
    for (std::size_t i = 0; i < open_.size(); ++i)
      if (!open_[i].is_closed && !has_positive_state(open_[i].group)) inverted.push_back(i);
    for (const auto i : inverted) {
      ++(open_[i].group.is_octet() ? n_octets_kept_ : n_families_kept_);
      force(i);
    }
    return !inverted.empty();
  }

  /// Adds the nodes that stay elsewhere. True if one of them is new here. Collective: one exchange.
  bool add_from(const par::Exchange& exchange) {
    bool any = false;
    par::fold_shared(
        exchange, [&](LocalId node) { return stays_[at(node)]; },
        [&](LocalId node, std::uint8_t theirs) {
          if (theirs != 0) any = stay(node) || any;
        });
    return any;
  }

  Settled take() && {
    Settled settled;
    auto& outcome = settled.outcome;
    outcome.octets_kept = n_octets_kept_;
    outcome.families_kept = n_families_kept_;
    outcome.octets_needed = n_needed_ - n_octets_kept_;
    auto& groups = settled.groups;
    reserve_array(groups, open_.size());
    std::ptrdiff_t n_in_order = 0;
    for (std::size_t i = 0; i < open_.size(); ++i) {
      const auto& group = open_[i].group;
      if (open_[i].is_closed) continue;
      ++(group.is_octet() ? outcome.octets_gone : outcome.families_closed);
      groups.push_back(group);
      if (i < n_at_start_) ++n_in_order;
    }
    const auto late = groups.begin() + n_in_order;
    const auto is_before = [](const Group& a, const Group& b) { return a.first < b.first; };
    std::sort(late, groups.end(), is_before);
    std::inplace_merge(groups.begin(), late, groups.end(), is_before);
    settled.node_stays = std::move(stays_);
    return settled;
  }

 private:
  bool stay(LocalId node) {
    auto& stays = stays_[at(node)];
    return std::exchange(stays, std::uint8_t{1}) == 0;
  }

  void start(const std::vector<Group>& octets) {
    auto octet = octets.begin();
    LocalId end = 0;
    for (LocalId c = 0; c < mesh_.n_cells(); c = end) {
      if (octet != octets.end() && octet->first == c) {
        end = octet->end;
        for (int corner = 0; corner < 4; ++corner) stay(octet->node[at(corner)]);
        open_.push_back({*octet, 0, false, octet->end - octet->first > 8});
        ++octet;
        continue;
      }
      end = end_of_base_cell(mesh_, c);
      start_base_cell(c, end);
    }
  }

  void start_base_cell(LocalId first, LocalId end) {
    const bool becomes_eight =
        std::any_of(flags_.begin() + first, flags_.begin() + end, [](std::int8_t flag) { return flag > 0; });
    if (mesh_.lineage[at(first)].is_removable() && !becomes_eight) {
      const auto family = family_group(mesh_, first);
      for (int corner = 0; corner < 4; ++corner) stay(family.node[at(corner)]);
      open_.push_back({family, 0, false, false});
      return;
    }
    for (auto c = first; c < end; ++c)
      for (const auto node : mesh_.cell_to_node[at(c)]) stay(node);
  }

  /// Marks of the parent: its midpoints that stay.
  EdgeMask marks_of(const Group& group) const {
    unsigned marks = 0;
    for (unsigned rest = group.mask_before(); rest != 0; rest &= rest - 1) {
      const int e = std::countr_zero(rest);
      if (stays_[at(group.node[at(4 + e)])] != 0) marks |= 1U << e;
    }
    return static_cast<EdgeMask>(marks);
  }

  /// An edge inside an edge or face of an octet's parent is marked. A mark on its diagonal is nobody else's.
  bool is_marked_inside(const Group& octet) const {
    for (auto c = octet.first; c < octet.end;) {
      const auto end = end_of_base_cell(mesh_, c);
      if (end - c > 1) {
        const auto family = family_group(mesh_, c);
        for (int e = 0; e < 6; ++e)
          if (const auto node = family.node[at(4 + e)]; node != invalid_local && stays_[at(node)] != 0) return true;
      }
      c = end;
    }
    return false;
  }

  refine::BaseCorners corners(const Group& group) const {
    return refine::base_corners(mesh_, level0_, level0_.row_of(group.first),
                                {group.node[0], group.node[1], group.node[2], group.node[3]});
  }

  /// True if a node stays that did not before, or a group was closed.
  bool apply_rules(std::size_t i) {
    auto& open = open_[i];
    const auto& group = open.group;
    const auto marks = marks_of(group);
    if (!group.is_octet() && marks == group.mask_before()) {
      open.is_closed = true;
      return false;
    }
    if (open.has_families && is_marked_inside(group)) {
      force(i);
      return true;
    }
    if (marks == open.marks) return false;
    const auto& known = mesh::closure_states[group.is_octet() ? 0 : group.before];
    const refine::CellShape shape(level0_, corners(group), {known.mask, known.cuts});
    const auto required = shape.closed_marks(marks, shape_floor_);
    if (required == all_edges || (required & ~static_cast<unsigned>(group.mask_before())) != 0) {
      force(i);
      return true;
    }
    open.marks = required;
    bool any = false;
    for (unsigned rest = required; rest != 0; rest &= rest - 1)
      any = stay(group.node[at(4 + std::countr_zero(rest))]) || any;
    return any;
  }

  void force(std::size_t i) {
    if (open_[i].group.is_octet()) ++n_needed_;
    close(i);
  }

  /// The group stays as it is; the children of an octet are base cells now.
  void close(std::size_t i) {
    open_[i].is_closed = true;
    const auto group = open_[i].group;
    for (const auto node : group.node)
      if (node != invalid_local) stay(node);
    if (!group.is_octet()) return;
    LocalId end = 0;
    for (auto c = group.first; c < group.end; c = end) {
      end = end_of_base_cell(mesh_, c);
      if (end - c > 1) open_.push_back({family_group(mesh_, c), 0, false, false});
    }
  }

  /// Chooses the state for the marks that are left; false if its cells are not all positive.
  bool has_positive_state(Group& group) const {
    const auto marks = marks_of(group);
    refine::MappedPoints mapped(level0_, corners(group));
    const EdgeMask existing = group.mask_before();
    for (int e = 0; e < 6; ++e)
      if ((existing >> e & 1U) != 0) mapped.put(e, mesh_.point(group.node[at(4 + e)]));
    const auto& points = mapped.points(static_cast<EdgeMask>(marks | existing));
    group.now = 0;
    if (marks == 0)
      return refine::is_far_from_flat(points) || geometry::is_positive(points[0], points[1], points[2], points[3]);
    const bool is_safe =
        refine::is_straight(points, group.is_octet() ? marks : existing) && refine::is_far_from_flat(points);
    const int before = group.is_octet() ? 0 : group.before;
    group.now = static_cast<refine::SplitState>(refine::choose_state(mapped, marks, before, is_safe));
    return group.now != 0;
  }

  const mesh::DistMesh& mesh_;
  mesh::Level0View level0_;
  std::span<const std::int8_t> flags_;
  double shape_floor_;
  std::vector<std::uint8_t> stays_;
  std::vector<Open> open_;
  std::size_t n_at_start_ = 0;  ///< of `open_`, ascending; the rest are families of forced octets
  std::int64_t n_needed_ = 0, n_octets_kept_ = 0, n_families_kept_ = 0;
};

}  // namespace

Settled settle_octets(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::Borders& borders,
                      const std::vector<Group>& octets, const Needs& needs) {
  Settling settling(mesh, octets, needs);
  const par::Exchange exchange(comm, borders.nodes);
  int rounds = 0;
  for (bool is_inverted = true; is_inverted;) {
    for (bool news = true; news; ++rounds) {
      settling.settle();
      news = comm.any(settling.add_from(exchange));
    }
    is_inverted = comm.any(settling.keep_inverted());
  }
  auto settled = std::move(settling).take();
  auto& outcome = settled.outcome;
  std::array<std::int64_t, 5> sums{outcome.octets_gone, outcome.octets_needed, outcome.octets_kept,
                                   outcome.families_closed, outcome.families_kept};
  comm.sum_in_place(sums);
  outcome = {sums[0], sums[1], sums[2], sums[3], sums[4], rounds};
  return settled;
}

}  // namespace pamr::coarsen
