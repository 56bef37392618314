// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/refine/closure.hpp"
#include "pamr/refine/mapped_points.hpp"

namespace pamr::refine {

/// What an edge of a family's member is to the parent.
enum class EdgeRole : std::uint8_t {
  parent,    ///< an edge of the parent without midpoint
  part,      ///< a half of a marked edge, or between two midpoints on a face: still an edge when the parent is red
  bisector,  ///< from a midpoint to the opposite corner of a face, or inside: gone when the parent is red
};

struct FamilyEdge {
  EdgeRole role = EdgeRole::parent;
  std::int8_t parent_edge = -1;  ///< of role `parent`
};

/// A node of a family in one of its members.
struct NodePlace {
  std::int8_t member = -1;
  std::int8_t slot = 0;
};

/// What the members of the families of one state are to their parent.
struct FamilyTable {
  /// Role of each edge of each member: `edge[child][edge]`.
  std::array<std::array<FamilyEdge, 6>, mesh::max_family_size> edge{};
  /// Edges of each member with that role.
  std::array<EdgeMask, mesh::max_family_size> edges_of_parent{}, edges_of_parts{};
  /// Bit i: the face in slot i of a member is part of a face of the parent that has one mark or two. Such faces have to
  /// stay or to be taken back on both sides.
  std::array<std::uint8_t, mesh::max_family_size> cut_slots{};
  /// Where the node of a code is found; member -1: there is no such node.
  std::array<NodePlace, 10> node{};
};

/// By state, that of regular cells included (of which nothing is asked).
extern const std::array<FamilyTable, regular_state> family_table;

/// What a member's marks say of the parent: the parent's edges among them, and `beyond_parent` when there are others.
unsigned marks_for_parent(int state, int child, EdgeMask marks);
inline constexpr unsigned beyond_parent = 0x40;

/// A closure family seen as its parent: nodes and marks by node code.
struct FamilyView {
  LocalId first = invalid_local;
  int state = 0;
  std::array<LocalId, 10> node{};                  ///< by code; `invalid_local` where there is none yet
  EdgeMask parent_marks = 0;                       ///< edges of the parent with a midpoint, old or new
  std::array<std::uint16_t, 10> part_is_marked{};  ///< bit b of entry a: the part from code a to code b is marked
  bool any_part_is_marked = false;
};

/// Gathers a whole family from its first member and the marks of its members (other bits are ignored). Local.
FamilyView view_family(const mesh::DistMesh& mesh, const std::vector<EdgeMask>& marks, LocalId first);

/// The parent's corners and the middles of its edges: existing nodes where they are, others where they would lie.
MappedPoints family_points(const mesh::DistMesh& mesh, const mesh::Level0View& level0, const FamilyView& family);

/// How a parent with these marks is split. `before`: state of the family that replaces it, whose cuts stay where a face
/// keeps its two marks; 0: there is none. `is_safe`: the midpoints lie in the middle of their edges, and the cell is
/// far from flat; otherwise only states count whose cells are positive where the nodes lie, and also where new ones lie
/// if they go back to the middles of their edges. 0: there is none.
int choose_state(const MappedPoints& mapped, EdgeMask marks, int before, bool is_safe);

struct FamilyPlan {
  RebuiltFamily family;
  /// Edges of members that the marks of the children of a red parent imply, beyond those that they have.
  std::vector<mesh::CellEdge> implied;
};

/// How the family is split anew for its marks: the state (with the diagonal for 1:8), and the states of the children.
/// `state` is 0 when no pattern gives positive cells only: its midpoints lie too far from their edges.
/// `is_early` is set when the marks of a child imply, with that shape floor, others on edges that do not exist yet.
FamilyPlan plan_family(const mesh::DistMesh& mesh, const FamilyView& family, double shape_floor);

}  // namespace pamr::refine
