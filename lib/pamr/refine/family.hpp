// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/refine/closure.hpp"
#include "pamr/refine/diagonal.hpp"

namespace pamr::refine {

/// What an edge of a family's member is to the parent.
enum class EdgeRole : std::uint8_t {
  parent,    ///< an edge of the parent without midpoint
  part,      ///< a half of a marked edge, or a side of the center of a split face: still an edge when the parent is red
  bisector,  ///< from a midpoint to the opposite corner of a face: gone when the parent is red
};

struct FamilyEdge {
  EdgeRole role = EdgeRole::parent;
  int parent_edge = -1;  ///< of role `parent`
};

namespace detail {

constexpr FamilyEdge make_role(int a, int b) {
  if (a < 4 && b < 4) return {EdgeRole::parent, mesh::tet::edge_of[at(a)][at(b)]};
  if (a >= 4 && b >= 4) return {EdgeRole::part, -1};
  const auto [p, q] = mesh::tet::edge_to_corner[at((a < 4 ? b : a) - 4)];
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
        const auto [p, q] = mesh::tet::edge_to_corner[at(e)];
        table[at(s)][at(c)][at(e)] = make_role(nodes[at(p)], nodes[at(q)]);
      }
  return table;
}

constexpr auto make_masks(const RoleTable& roles, EdgeRole role) {
  std::array<std::array<EdgeMask, 4>, n_states> table{};
  for (int s = 1; s < 11; ++s)
    for (int c = 0; c < split_pattern[at(s)].n_children; ++c)
      for (int e = 0; e < 6; ++e)
        if (roles[at(s)][at(c)][at(e)].role == role)
          table[at(s)][at(c)] = static_cast<EdgeMask>(table[at(s)][at(c)] | 1U << e);
  return table;
}

/// A node of a family in one of its members.
struct NodePlace {
  std::int8_t member = -1;
  std::int8_t slot = 0;
};

constexpr auto make_places() {
  std::array<std::array<NodePlace, 10>, n_states> table{};
  for (int s = 1; s < 11; ++s)
    for (int c = 0; c < split_pattern[at(s)].n_children; ++c)
      for (int slot = 0; slot < 4; ++slot)
        table[at(s)][at(split_pattern[at(s)].child_to_node[at(c)][at(slot)])] = {to_code(c), to_code(slot)};
  return table;
}

using MeaningTable = std::array<std::array<std::array<std::uint8_t, 64>, 4>, 11>;

constexpr MeaningTable make_meanings(const RoleTable& roles) {
  MeaningTable table{};
  for (int s = 1; s < 11; ++s)
    for (int c = 0; c < split_pattern[at(s)].n_children; ++c)
      for (int marks = 0; marks < 64; ++marks)
        for (int e = 0; e < 6; ++e) {
          if ((marks >> e & 1) == 0) continue;
          const auto edge = roles[at(s)][at(c)][at(e)];
          auto& meaning = table[at(s)][at(c)][at(marks)];
          meaning = static_cast<std::uint8_t>(meaning | 1U << (edge.role == EdgeRole::parent ? edge.parent_edge : 6));
        }
  return table;
}

}  // namespace detail

/// Where the node of a code is found in a family made by a state: `node_places[state][code]`, member -1: no such node.
inline constexpr auto node_places = detail::make_places();

/// Role of each edge of each member in a family made by a state: `family_edges[state][child][edge]`.
inline constexpr auto family_edges = detail::make_roles();

/// Edges of that role in each member: `edges_of_parent[state][child]`, `edges_of_parts[state][child]`.
inline constexpr auto edges_of_parent = detail::make_masks(family_edges, EdgeRole::parent);
inline constexpr auto edges_of_parts = detail::make_masks(family_edges, EdgeRole::part);

/// What a member's marks say of the parent: the parent's edges among them, and `beyond_parent` when there are others.
inline constexpr auto marks_for_parent = detail::make_meanings(family_edges);
inline constexpr unsigned beyond_parent = 0x40;

/// Role of edge `edge` of member `child` in a family made by `state`.
constexpr FamilyEdge family_edge(int state, int child, int edge) {
  return family_edges[at(state)][at(child)][at(edge)];
}

/// A closure family seen as its parent: nodes and marks by node code.
struct FamilyView {
  LocalId first = invalid_local;
  int state = 0;
  std::array<LocalId, 10> node{};                  ///< by code; `invalid_local` where there is none yet
  EdgeMask parent_marks = 0;                       ///< edges of the parent with a midpoint, old or new
  std::array<std::uint16_t, 10> part_is_marked{};  ///< bit b of entry a: the part from code a to code b is marked
  bool any_part_is_marked = false;
};

/// Gathers a whole family from its first member and the marks of its members. Local.
FamilyView view_family(const mesh::DistMesh& mesh, const std::vector<EdgeMask>& marks, LocalId first);

/// Positions of the parent's corners and of the midpoints of its edges, the existing ones where they are, the others in
/// the middle of their edge.
SplitPoints family_points(const mesh::DistMesh& mesh, const FamilyView& family);

/// How the family is split anew when `view.parent_marks` is legal: the state (with the diagonal for 1:8) and the marks
/// of the children. `state` is -1 when no pattern gives positive cells only: its midpoints lie too far from their
/// edges.
RebuiltFamily plan_family(const mesh::DistMesh& mesh, const FamilyView& family);

}  // namespace pamr::refine
