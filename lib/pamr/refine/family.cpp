// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/family.hpp"

namespace pamr::refine {

namespace {

using mesh::tet::edge_to_corner;

constexpr std::size_t at(int i) { return static_cast<std::size_t>(i); }

constexpr FamilyEdge make_role(int a, int b) {
  if (a < 4 && b < 4) return {EdgeRole::parent, mesh::tet::edge_of[at(a)][at(b)]};
  if (a >= 4 && b >= 4) return {EdgeRole::part, -1};
  const auto [p, q] = edge_to_corner[at((a < 4 ? b : a) - 4)];
  const int corner = a < 4 ? a : b;
  return {p == corner || q == corner ? EdgeRole::part : EdgeRole::bisector, -1};
}

using RoleTable = std::array<std::array<std::array<FamilyEdge, 6>, 4>, n_states>;

constexpr RoleTable make_roles() {
  RoleTable table{};
  for (int s = 1; s < 11; ++s)
    for (int c = 0; c < split_pattern[at(s)].n_children; ++c)
      for (int e = 0; e < 6; ++e) {
        const auto& nodes = split_pattern[at(s)].child_to_node[at(c)];
        table[at(s)][at(c)][at(e)] =
            make_role(nodes[at(edge_to_corner[at(e)][0])], nodes[at(edge_to_corner[at(e)][1])]);
      }
  return table;
}

constexpr RoleTable roles = make_roles();

}  // namespace

FamilyEdge family_edge(int state, int child, int edge) { return roles[at(state)][at(child)][at(edge)]; }

FamilyView view_family(const mesh::DistMesh& mesh, const std::vector<EdgeMask>& marks, LocalId first) {
  FamilyView view;
  view.first = first;
  view.state = state_of_family(mesh.lineage[at(first)]);
  view.node.fill(invalid_local);
  const auto& pattern = split_pattern[at(view.state)];
  view.parent_marks = pattern.mask;
  for (int child = 0; child < pattern.n_children; ++child) {
    const auto& code = pattern.child_to_node[at(child)];
    const auto& nodes = mesh.cell_to_node[at(first + child)];
    for (int slot = 0; slot < 4; ++slot) view.node[at(code[at(slot)])] = nodes[at(slot)];
    for (int e = 0; e < 6; ++e) {
      if ((marks[at(first + child)] >> e & 1) == 0) continue;
      const auto edge = family_edge(view.state, child, e);
      const auto a = code[at(edge_to_corner[at(e)][0])], b = code[at(edge_to_corner[at(e)][1])];
      if (edge.role == EdgeRole::parent)
        view.parent_marks = static_cast<EdgeMask>(view.parent_marks | 1 << edge.parent_edge);
      if (edge.role == EdgeRole::part) {
        view.part_is_marked[at(a)] = static_cast<std::uint16_t>(view.part_is_marked[at(a)] | 1 << b);
        view.part_is_marked[at(b)] = static_cast<std::uint16_t>(view.part_is_marked[at(b)] | 1 << a);
      }
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
  plan.is_safe = is_straight(points) && is_far_from_flat(points);
  if (plan.state == 11) plan.state += choose_diagonal(points, plan.is_safe);
  if (plan.state < 0 || !(plan.is_safe || all_children_positive(points, plan.state))) {
    plan.state = -1;
    return plan;
  }
  const auto& pattern = split_pattern[at(plan.state)];
  for (int child = 0; child < pattern.n_children; ++child) {
    const auto& code = pattern.child_to_node[at(child)];
    EdgeMask marks = 0;
    for (int e = 0; e < 6; ++e) {
      const auto a = code[at(edge_to_corner[at(e)][0])], b = code[at(edge_to_corner[at(e)][1])];
      if ((family.part_is_marked[at(a)] >> b & 1) != 0) marks = static_cast<EdgeMask>(marks | 1 << e);
    }
    plan.child_marks[at(child)] = marks;
    plan.n_children += split_pattern[at(state_of_mask[marks])].n_children;
  }
  return plan;
}

}  // namespace pamr::refine
