// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "pamr/base/index.hpp"
#include "pamr/mesh/closure_state.hpp"
#include "pamr/mesh/tet.hpp"

/// The 275 ways to split a cell and everything that follows from them, as constant tables.
///
/// A way to split is named by its state: 0 nothing; 1 to 271 the closure families (`mesh/closure_state.hpp`);
/// `regular_state` + d: 1:8 with inner diagonal d, which joins the midpoints of edges d and 5 - d. Nodes of the
/// children are named by code: 0..3 the corners, 4 + e the midpoint of edge e. A part of a split face is named by its
/// place: 0..3 a corner of the cell, `center`, or `whole` for a face without marks.
///
///     one mark: a half is named by its    two marks: by the common end s, the      three marks: by the
///     end of the marked edge              other end t of the edge it is cut        corners, and the center
///                                         from, and the third corner o
///               c                                   o                                    c
///              /|.                                 / .                                  / .
///             / | .                              m2 o .                               m2--m1
///            / a|b .                             / `. t .                             / . / .
///           a---m---b                           s--s-m-----t                        a---m3---b
namespace pamr::refine {

inline constexpr int regular_state = static_cast<int>(mesh::closure_states.size());
inline constexpr int n_states = regular_state + 3;
inline constexpr int max_children = 8;
inline constexpr int center = 4;
inline constexpr int whole = 5;
inline constexpr int n_places = 6;

/// State of a split; `mesh::Lineage::state` of the children where they are a family.
using SplitState = std::uint16_t;
using EdgeMask = std::uint8_t;
inline constexpr EdgeMask all_edges = 0x3f;

struct SplitPattern {
  int n_children = 0;
  /// Node codes of each child, oriented as the parent.
  std::array<std::array<std::int8_t, 4>, max_children> child_to_node{};
  /// Across each face of each child: a sibling (0..7) or -(1 + face * n_places + place) on a face of the parent.
  std::array<std::array<std::int8_t, 4>, max_children> child_to_child{};
  /// The child that holds a part of a face, and its slot there; -1 where the face has no such part.
  std::array<std::array<std::int8_t, n_places>, 4> face_to_child{};
  std::array<std::array<std::int8_t, n_places>, 4> face_to_slot{};
  /// Cuts of the faces with two marks: those of `mesh::ClosureState`.
  std::uint8_t cuts = 0;
  EdgeMask mask = 0;
};

constexpr int outer_face(int code) { return (-code - 1) / n_places; }
constexpr int outer_place(int code) { return (-code - 1) % n_places; }
constexpr bool is_regular_split(int state) { return state >= regular_state; }

/// By state.
extern const std::array<SplitPattern, n_states> split_pattern;

/// How a face between two siblings looks from the other one: its slot there, and the slots of its corners.
struct SiblingFace {
  std::int8_t face = 0;
  std::array<std::int8_t, 4> corner{};
};
/// `sibling_face[state][child][face]`, where a sibling is across that face.
extern const std::array<std::array<std::array<SiblingFace, 4>, max_children>, n_states> sibling_face;

/// Number of marks on a face: `n_face_marks[mask][face]`.
extern const std::array<std::array<std::uint8_t, 4>, 64> n_face_marks;

/// States of a set of marks with given cuts; the second one only where an inner edge can be chosen; 0: none. No marks
/// and all six have no entry.
struct StateChoice {
  std::array<SplitState, 2> state{};
};
/// `states_of_marks[mask][cuts]`: bits of `cuts` for faces without two marks are 0.
extern const std::array<std::array<StateChoice, 16>, 64> states_of_marks;

/// The smallest set of marks that holds the given ones and has one of the paper's templates: none, one edge, the edges
/// of one face, all six. Two marks on a face become three, anything else six. The policies other than `removable` use
/// it.
extern const std::array<EdgeMask, 64> template_mask;

/// State of such a set, -1 for others; all six marks give the state of diagonal 0, to which the diagonal is added.
extern const std::array<std::int16_t, 64> state_of_template;

/// Six volumes of a child of the reference cell, in eighths of those of the parent.
int child_volume(const std::array<std::int8_t, 4>& nodes);

}  // namespace pamr::refine
