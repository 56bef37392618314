// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/family.hpp"

#include <bit>

#include "pamr/base/index.hpp"

namespace pamr::refine {

namespace {

using mesh::tet::edge_to_corner;

}  // namespace

FamilyView view_family(const mesh::DistMesh& mesh, const std::vector<EdgeMask>& marks, LocalId first) {
  FamilyView view;
  view.first = first;
  view.state = state_of_family(mesh.lineage[at(first)]);
  for (int code = 0; code < 10; ++code) {
    const auto [member, slot] = node_places[at(view.state)][at(code)];
    view.node[at(code)] = member < 0 ? invalid_local : mesh.cell_to_node[at(first + member)][at(slot)];
  }
  const auto& pattern = split_pattern[at(view.state)];
  view.parent_marks = pattern.mask;
  for (int child = 0; child < pattern.n_children; ++child) {
    const auto all = marks[at(first + child)];
    view.parent_marks =
        static_cast<EdgeMask>(view.parent_marks | (marks_for_parent[at(view.state)][at(child)][all] & all_edges));
    const auto& code = pattern.child_to_node[at(child)];
    for (unsigned rest = all & edges_of_parts[at(view.state)][at(child)]; rest != 0; rest &= rest - 1) {
      const auto [p, q] = edge_to_corner[at(std::countr_zero(rest))];
      const auto a = code[at(p)], b = code[at(q)];
      view.part_is_marked[at(a)] = static_cast<std::uint16_t>(view.part_is_marked[at(a)] | 1 << b);
      view.part_is_marked[at(b)] = static_cast<std::uint16_t>(view.part_is_marked[at(b)] | 1 << a);
      view.any_part_is_marked = true;
    }
  }
  return view;
}

SplitPoints family_points(const mesh::DistMesh& mesh, const FamilyView& family) {
  SplitPoints points;
  for (int code = 0; code < 4; ++code) points[at(code)] = mesh.point(family.node[at(code)]);
  for (int e = 0; e < 6; ++e) {
    const auto node = family.node[at(4 + e)];
    points[at(4 + e)] = node != invalid_local ? mesh.point(node)
                                              : geometry::midpoint(points[at(edge_to_corner[at(e)][0])],
                                                                   points[at(edge_to_corner[at(e)][1])]);
  }
  return points;
}

RebuiltFamily plan_family(const mesh::DistMesh& mesh, const FamilyView& family) {
  RebuiltFamily plan;
  plan.first = family.first;
  const auto points = family_points(mesh, family);
  plan.state = state_of_mask[family.parent_marks];
  plan.is_safe = is_straight(points, split_pattern[at(family.state)].mask) && is_far_from_flat(points);
  if (plan.state == 11) plan.state += choose_diagonal(points, plan.is_safe);
  if (plan.state < 0 || !(plan.is_safe || all_children_positive(points, plan.state))) {
    plan.state = -1;
    return plan;
  }
  const auto& pattern = split_pattern[at(plan.state)];
  if (!family.any_part_is_marked) {
    plan.n_children = pattern.n_children;
    return plan;
  }
  for (int child = 0; child < pattern.n_children; ++child) {
    const auto& code = pattern.child_to_node[at(child)];
    EdgeMask marks = 0;
    unsigned corners = 0, ends = 0;
    for (const auto c : code) {
      corners |= 1U << c;
      ends |= family.part_is_marked[at(c)];
    }
    for (int e = 0; e < 6 && (corners & ends) != 0; ++e) {
      const auto a = code[at(edge_to_corner[at(e)][0])], b = code[at(edge_to_corner[at(e)][1])];
      if ((family.part_is_marked[at(a)] >> b & 1) != 0) marks = static_cast<EdgeMask>(marks | 1 << e);
    }
    plan.child_marks[at(child)] = marks;
    plan.n_children += split_pattern[at(state_of_mask[marks])].n_children;
  }
  return plan;
}

}  // namespace pamr::refine
