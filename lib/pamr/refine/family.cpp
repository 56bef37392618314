// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/family.hpp"

#include <algorithm>
#include <bit>
#include <optional>

#include "pamr/base/index.hpp"
#include "pamr/refine/cell_shape.hpp"

namespace pamr::refine {

namespace {

using mesh::tet::edge_to_corner;

/// Bit f: the node lies on face f of the parent.
constexpr unsigned faces_of(int code) {
  unsigned faces = 0xf;
  if (code < 4) return faces & ~(1U << code);
  for (const int corner : edge_to_corner[at(code - 4)]) faces &= ~(1U << corner);
  return faces;
}

constexpr FamilyEdge role_of(int a, int b) {
  if (a < 4 && b < 4) return {EdgeRole::parent, static_cast<std::int8_t>(mesh::tet::edge_of[at(a)][at(b)])};
  if (a >= 4 && b >= 4) return {(faces_of(a) & faces_of(b)) != 0 ? EdgeRole::part : EdgeRole::bisector, -1};
  const auto [p, q] = edge_to_corner[at(std::max(a, b) - 4)];
  const int corner = std::min(a, b);
  return {p == corner || q == corner ? EdgeRole::part : EdgeRole::bisector, -1};
}

constexpr bool is_on_cut_face(const mesh::ClosureState& state, const std::array<std::int8_t, 4>& nodes, int slot) {
  unsigned faces = 0xf;
  for (int i = 0; i < 4; ++i)
    if (i != slot) faces &= faces_of(nodes[at(i)]);
  if (faces == 0) return false;
  const int n_marks =
      std::popcount(static_cast<unsigned>(state.mask & mesh::tet::face_edge_mask[at(std::countr_zero(faces))]));
  return n_marks == 1 || n_marks == 2;
}

constexpr FamilyTable make_table(const mesh::ClosureState& state) {
  FamilyTable table;
  for (int c = 0; c < state.family.n_children; ++c) {
    const auto& nodes = state.family.child_to_node[at(c)];
    for (int e = 0; e < 6; ++e) {
      const auto [p, q] = edge_to_corner[at(e)];
      const auto edge = role_of(nodes[at(p)], nodes[at(q)]);
      table.edge[at(c)][at(e)] = edge;
      auto& parents = table.edges_of_parent[at(c)];
      auto& parts = table.edges_of_parts[at(c)];
      if (edge.role == EdgeRole::parent) parents = static_cast<EdgeMask>(parents | 1U << e);
      if (edge.role == EdgeRole::part) parts = static_cast<EdgeMask>(parts | 1U << e);
    }
    auto& cut = table.cut_slots[at(c)];
    for (int slot = 0; slot < 4; ++slot) {
      if (is_on_cut_face(state, nodes, slot)) cut = static_cast<std::uint8_t>(cut | 1U << slot);
      table.node[at(nodes[at(slot)])] = {static_cast<std::int8_t>(c), static_cast<std::int8_t>(slot)};
    }
  }
  return table;
}

constexpr std::array<FamilyTable, regular_state> make_tables() {
  std::array<FamilyTable, regular_state> tables{};
  for (std::size_t s = 1; s < tables.size(); ++s) tables[s] = make_table(mesh::closure_states[s]);
  return tables;
}

/// Where the nodes of a family lie, and where they lie when new ones have gone back to the middles of their edges,
/// which other cells can make them do.
struct BothPlaces {
  const SplitPoints& points;
  std::optional<SplitPoints> gone_back{};  ///< none: the same

  bool all_positive(int state) const {
    return all_children_positive(points, state) && (!gone_back || all_children_positive(*gone_back, state));
  }
};

BothPlaces both_places(const MappedPoints& mapped, EdgeMask middles) {
  BothPlaces both{mapped.points(middles)};
  if (mapped.is_bent() && (middles & ~mapped.existing()) != 0) both.gone_back = mapped.points_gone_back(middles);
  return both;
}

/// The best of the states with these marks and cuts whose children are positive in both places; 0: there is none.
int best_positive_state(const BothPlaces& both, const StateChoice& choice) {
  const auto& points = both.points;
  int best = 0;
  double best_shape = 0;
  const auto inner_edge = [&points](int state) {
    const int d = mesh::closure_states[at(state)].inner_edge;
    return std::array{points[at(4 + d)], points[at(9 - d)]};
  };
  for (const int state : choice.state) {
    if (state == 0 || !both.all_positive(state)) continue;
    const double worst = worst_child_shape(points, state);
    const bool is_tied = best != 0 && worst >= equal_cubes * best_shape && best_shape >= equal_cubes * worst;
    const bool is_better = best == 0 || (is_tied ? mesh::closure_states[at(best)].inner_edge >= 0 &&
                                                       is_earlier_edge(inner_edge(state), inner_edge(best))
                                                 : worst > best_shape);
    if (!is_better) continue;
    best = state;
    best_shape = worst;
  }
  return best;
}

/// How a child is split that has these marks. At a corner with three marked edges all six edges of the child exist.
int state_of_child(const mesh::Level0View& level0, const BaseCorners& corners, const CellShape& shape, EdgeMask marks) {
  if (marks != all_edges) return shape.best_state(marks);
  const MappedPoints points(level0, corners);
  return regular_state + choose_diagonal(points.points(all_edges), !points.is_bent());
}

/// The edge of a member between the nodes of two codes; no cell: there is none that is still an edge when the parent is
/// red.
mesh::CellEdge existing_part(const FamilyView& family, int a, int b) {
  const auto& pattern = split_pattern[at(family.state)];
  for (int child = 0; child < pattern.n_children; ++child)
    for (unsigned rest = family_table[at(family.state)].edges_of_parts[at(child)]; rest != 0; rest &= rest - 1) {
      const int e = std::countr_zero(rest);
      const auto [p, q] = edge_to_corner[at(e)];
      const int c = pattern.child_to_node[at(child)][at(p)], d = pattern.child_to_node[at(child)][at(q)];
      if ((c == a && d == b) || (c == b && d == a)) return {family.first + child, e};
    }
  return {};
}

/// Marks of a child of the parent, from those on the parts of the family.
EdgeMask marks_of_child(const FamilyView& family, const std::array<std::int8_t, 4>& code) {
  unsigned marks = 0, corners = 0, ends = 0;
  for (const auto c : code) {
    corners |= 1U << c;
    ends |= family.part_is_marked[at(c)];
  }
  for (int e = 0; e < 6 && (corners & ends) != 0; ++e) {
    const auto a = code[at(edge_to_corner[at(e)][0])], b = code[at(edge_to_corner[at(e)][1])];
    if ((family.part_is_marked[at(a)] >> b & 1) != 0) marks |= 1U << e;
  }
  return static_cast<EdgeMask>(marks);
}

}  // namespace

constexpr std::array<FamilyTable, regular_state> family_table = make_tables();

unsigned marks_for_parent(int state, int child, EdgeMask marks) {
  const auto& edges = family_table[at(state)].edge[at(child)];
  unsigned meaning = 0;
  for (unsigned rest = marks; rest != 0; rest &= rest - 1) {
    const auto edge = edges[at(std::countr_zero(rest))];
    meaning |= edge.role == EdgeRole::parent ? 1U << edge.parent_edge : beyond_parent;
  }
  return meaning;
}

FamilyView view_family(const mesh::DistMesh& mesh, const std::vector<EdgeMask>& marks, LocalId first) {
  FamilyView view;
  view.first = first;
  view.state = mesh.lineage[at(first)].state();
  const auto& table = family_table[at(view.state)];
  for (int code = 0; code < 10; ++code) {
    const auto [member, slot] = table.node[at(code)];
    view.node[at(code)] = member < 0 ? invalid_local : mesh.cell_to_node[at(first + member)][at(slot)];
  }
  const auto& pattern = split_pattern[at(view.state)];
  unsigned parent_marks = pattern.mask;
  for (int child = 0; child < pattern.n_children; ++child) {
    const auto all = static_cast<EdgeMask>(marks[at(first + child)] & all_edges);
    parent_marks |= marks_for_parent(view.state, child, all) & all_edges;
    const auto& code = pattern.child_to_node[at(child)];
    for (unsigned rest = all & table.edges_of_parts[at(child)]; rest != 0; rest &= rest - 1) {
      const auto [p, q] = edge_to_corner[at(std::countr_zero(rest))];
      const auto a = code[at(p)], b = code[at(q)];
      view.part_is_marked[at(a)] = static_cast<std::uint16_t>(view.part_is_marked[at(a)] | 1 << b);
      view.part_is_marked[at(b)] = static_cast<std::uint16_t>(view.part_is_marked[at(b)] | 1 << a);
      view.any_part_is_marked = true;
    }
  }
  view.parent_marks = static_cast<EdgeMask>(parent_marks);
  return view;
}

MappedPoints family_points(const mesh::DistMesh& mesh, const mesh::Level0View& level0, const FamilyView& family) {
  const auto& node = family.node;
  MappedPoints points(level0,
                      base_corners(mesh, level0, level0.row_of(family.first), {node[0], node[1], node[2], node[3]}));
  for (int e = 0; e < 6; ++e)
    if (node[at(4 + e)] != invalid_local) points.put(e, mesh.point(node[at(4 + e)]));
  return points;
}

int choose_state(const MappedPoints& mapped, EdgeMask marks, int before, bool is_safe) {
  const auto& points = mapped.points(marks);
  if (marks == all_edges) {
    const int state = regular_state + choose_diagonal(points, is_safe);
    return is_safe || both_places(mapped, marks).all_positive(state) ? state : 0;
  }
  if (const int only = is_safe ? only_state(marks) : 0; only != 0) return only;
  const auto& known = mesh::closure_states[at(before)];
  const CellShape shape(geometry::TetPoints{points[0], points[1], points[2], points[3]}, {known.mask, known.cuts});
  if (is_safe) return shape.best_state(marks);
  return best_positive_state(both_places(mapped, marks), states_of_marks[marks][shape.cuts(marks)]);
}

FamilyPlan plan_family(const mesh::DistMesh& mesh, const FamilyView& family, double shape_floor) {
  FamilyPlan result;
  auto& plan = result.family;
  plan.first = family.first;
  const mesh::Level0View level0(mesh);
  const auto mapped = family_points(mesh, level0, family);
  const auto& points = mapped.points(family.parent_marks);
  plan.is_safe = is_straight(points, family.parent_marks) && is_far_from_flat(points);
  plan.state = static_cast<SplitState>(choose_state(mapped, family.parent_marks, family.state, plan.is_safe));
  if (plan.state == 0) return result;
  const auto& pattern = split_pattern[plan.state];
  plan.n_children = static_cast<std::uint8_t>(pattern.n_children);
  if (!family.any_part_is_marked) return result;
  for (int child = 0; child < pattern.n_children; ++child) {
    const auto& code = pattern.child_to_node[at(child)];
    const auto marks = marks_of_child(family, code);
    if (marks == 0) continue;
    const auto corners = mapped.child(code);
    const CellShape shape(level0, corners);
    const unsigned added = shape.closed_marks(marks, shape_floor) & ~static_cast<unsigned>(marks);
    for (unsigned rest = added; rest != 0; rest &= rest - 1) {
      const auto [p, q] = edge_to_corner[at(std::countr_zero(rest))];
      if (const auto edge = existing_part(family, code[at(p)], code[at(q)]); edge.cell != invalid_local)
        result.implied.push_back(edge);
      else
        plan.is_early = true;
    }
    const auto state = static_cast<SplitState>(state_of_child(level0, corners, shape, marks));
    plan.child_state[at(child)] = state;
    plan.n_children = static_cast<std::uint8_t>(plan.n_children + split_pattern[state].n_children - 1);
  }
  return result;
}

}  // namespace pamr::refine
