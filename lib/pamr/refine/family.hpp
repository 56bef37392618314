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
  part,      ///< a half of a marked edge, or a side of the centre of a split face: still an edge when the parent is red
  bisector,  ///< from a midpoint to the opposite corner of a face: gone when the parent is red
};

struct FamilyEdge {
  EdgeRole role = EdgeRole::parent;
  int parent_edge = -1;  ///< of role `parent`
};

/// Role of edge `edge` of member `child` in a family made by `state`.
FamilyEdge family_edge(int state, int child, int edge);

/// A closure family seen as its parent: nodes and marks by node code.
struct FamilyView {
  LocalId first = invalid_local;
  int state = 0;
  std::array<LocalId, 10> node{};                  ///< by code; `invalid_local` where there is none yet
  EdgeMask parent_marks = 0;                       ///< edges of the parent with a midpoint, old or new
  std::array<std::uint16_t, 10> part_is_marked{};  ///< bit b of entry a: the part from code a to code b is marked
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
