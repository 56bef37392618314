// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>

#include "pamr/base/index.hpp"
#include "pamr/mesh/families.hpp"
#include "pamr/mesh/tet.hpp"

/// The 14 ways to split a cell and everything that follows from them, as constant tables.
///
/// A way to split is named by its state: 0 nothing; 1 + e: 1:2 on edge e; 7 + f: 1:4 on face f; 11 + d: 1:8 with inner
/// diagonal d, which joins the midpoints of edges d and 5 - d. Nodes of the children are named by code: 0..3 the
/// corners, 4 + e the midpoint of edge e. A part of a split face is named by its place: 0..3 the corner of the cell
/// that it keeps (of a face with one mark: the end of the marked edge), `center`, or `whole` for a face without marks.
namespace pamr::refine {

inline constexpr int n_states = 14;
inline constexpr int max_children = 8;
inline constexpr int center = 4;
inline constexpr int whole = 5;
inline constexpr int n_places = 6;

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
  /// Kind and template index of the family that the children form.
  mesh::FamilyKind kind = mesh::FamilyKind::regular;
  int index = 0;
  EdgeMask mask = 0;
};

constexpr int outer_face(int code) { return (-code - 1) / n_places; }
constexpr int outer_place(int code) { return (-code - 1) % n_places; }

namespace detail {

constexpr std::int8_t to_code(int value) { return static_cast<std::int8_t>(value); }
constexpr int midpoint_code(int corner_a, int corner_b) { return 4 + mesh::tet::edge_of[at(corner_a)][at(corner_b)]; }

/// Twice the position of a node of the reference cell (corners at the origin and the unit vectors).
constexpr std::array<int, 3> doubled_position(int code) {
  std::array<int, 3> p{};
  const auto add = [&p](int corner) {
    if (corner > 0) p[at(corner - 1)] += 1;
  };
  if (code < 4) {
    add(code);
    add(code);
  } else {
    add(mesh::tet::edge_to_corner[at(code - 4)][0]);
    add(mesh::tet::edge_to_corner[at(code - 4)][1]);
  }
  return p;
}

constexpr int determinant(const std::array<std::int8_t, 4>& nodes) {
  const auto o = doubled_position(nodes[0]);
  std::array<std::array<int, 3>, 3> d{};
  for (int i = 0; i < 3; ++i) {
    const auto p = doubled_position(nodes[at(i + 1)]);
    for (int k = 0; k < 3; ++k) d[at(i)][at(k)] = p[at(k)] - o[at(k)];
  }
  return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
         d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
}

constexpr void add_child(SplitPattern& p, std::array<std::int8_t, 4> nodes) {
  p.child_to_node[at(p.n_children++)] = nodes;
}

/// 1:2 or 1:4.
constexpr void split_closure(SplitPattern& p, mesh::FamilyKind kind, int index) {
  p.kind = kind;
  p.index = index;
  const auto& family = mesh::family_template(kind, index);
  for (int child = 0; child < family.n_children; ++child) add_child(p, family.child_to_node[at(child)]);
}

/// Corner children 0..3, then the four cells around the diagonal: each holds its two ends and one edge of the ring of
/// the other four midpoints.
constexpr void split_all(SplitPattern& p, int diagonal) {
  for (int kept = 0; kept < 4; ++kept) {
    std::array<std::int8_t, 4> corner{};
    for (int slot = 0; slot < 4; ++slot) corner[at(slot)] = to_code(slot == kept ? kept : midpoint_code(kept, slot));
    add_child(p, corner);
  }
  const int first = 4 + diagonal, second = 4 + mesh::tet::opposite_edge(diagonal);
  for (int e = 0; e < 6; ++e)
    for (int g = e + 1; g < 6; ++g) {
      const bool on_ring = e != diagonal && g != diagonal && 4 + e != second && 4 + g != second && e + g != 5;
      if (!on_ring) continue;
      std::array<std::int8_t, 4> inner{to_code(first), to_code(second), to_code(4 + e), to_code(4 + g)};
      if (determinant(inner) < 0) inner = {inner[0], inner[1], inner[3], inner[2]};
      add_child(p, inner);
    }
}

constexpr bool lies_on_face(int code, int face) {
  return code < 4 ? code != face : (mesh::tet::face_edge_mask[at(face)] >> (code - 4) & 1) != 0;
}

/// Place of the triangle that a child shows on a face of its parent.
constexpr int place_on_face(const SplitPattern& p, const std::array<std::int8_t, 4>& nodes, int slot, int face) {
  const EdgeMask marks = static_cast<EdgeMask>(p.mask & mesh::tet::face_edge_mask[at(face)]);
  const int n_marks = std::popcount(marks);
  if (n_marks == 0) return whole;
  int place = center;
  for (int i = 0; i < 4; ++i) {
    if (i == slot || nodes[at(i)] >= 4) continue;
    // with one mark both parts keep the opposite corner: the end of the marked edge names the part
    if (n_marks == 3) place = nodes[at(i)];
    const auto [a, b] = mesh::tet::edge_to_corner[at(std::countr_zero(marks))];
    if (n_marks == 1 && (nodes[at(i)] == a || nodes[at(i)] == b)) place = nodes[at(i)];
  }
  return place;
}

constexpr bool same_triangle(const std::array<std::int8_t, 4>& a, int slot_a, const std::array<std::int8_t, 4>& b,
                             int slot_b) {
  for (int i = 0; i < 4; ++i) {
    if (i == slot_a) continue;
    bool found = false;
    for (int k = 0; k < 4; ++k) found = found || (k != slot_b && a[at(i)] == b[at(k)]);
    if (!found) return false;
  }
  return true;
}

constexpr void link(SplitPattern& p) {
  for (auto& face : p.face_to_child) face.fill(-1);
  for (auto& face : p.face_to_slot) face.fill(-1);
  for (int c = 0; c < p.n_children; ++c)
    for (int s = 0; s < 4; ++s) {
      const auto& nodes = p.child_to_node[at(c)];
      auto& link = p.child_to_child[at(c)][at(s)];
      for (int face = 0; face < 4; ++face) {
        bool on = true;
        for (int i = 0; i < 4; ++i) on = on && (i == s || lies_on_face(nodes[at(i)], face));
        if (!on) continue;
        const int place = place_on_face(p, nodes, s, face);
        link = to_code(-(1 + face * n_places + place));
        p.face_to_child[at(face)][at(place)] = to_code(c);
        p.face_to_slot[at(face)][at(place)] = to_code(s);
      }
      for (int other = 0; other < p.n_children; ++other)
        for (int t = 0; t < 4; ++t)
          if (other != c && same_triangle(nodes, s, p.child_to_node[at(other)], t)) link = to_code(other);
    }
}

constexpr std::array<SplitPattern, n_states> make_patterns() {
  std::array<SplitPattern, n_states> patterns{};
  add_child(patterns[0], {0, 1, 2, 3});
  for (int e = 0; e < 6; ++e) {
    auto& p = patterns[at(1 + e)];
    p.mask = static_cast<EdgeMask>(1U << e);
    split_closure(p, mesh::FamilyKind::edge, e);
  }
  for (int f = 0; f < 4; ++f) {
    auto& p = patterns[at(7 + f)];
    p.mask = mesh::tet::face_edge_mask[at(f)];
    split_closure(p, mesh::FamilyKind::face, f);
  }
  for (int d = 0; d < 3; ++d) {
    auto& p = patterns[at(11 + d)];
    p.mask = all_edges;
    split_all(p, d);
  }
  for (auto& p : patterns) link(p);
  return patterns;
}

constexpr EdgeMask make_legal(int mask) {
  if (std::popcount(static_cast<unsigned>(mask)) <= 1) return static_cast<EdgeMask>(mask);
  for (const auto face : mesh::tet::face_edge_mask)
    if ((mask & ~face) == 0) return face;
  return all_edges;
}

constexpr std::array<EdgeMask, 64> make_legal_masks() {
  std::array<EdgeMask, 64> table{};
  for (int mask = 0; mask < 64; ++mask) table[at(mask)] = make_legal(mask);
  return table;
}

constexpr std::array<std::int8_t, 64> make_states() {
  std::array<std::int8_t, 64> table{};
  for (auto& entry : table) entry = -1;
  for (int s = n_states - 1; s >= 0; --s) table[make_patterns()[at(s)].mask] = to_code(s);
  return table;
}

}  // namespace detail

inline constexpr auto split_pattern = detail::make_patterns();

/// The smallest legal set of marks that holds the given ones: none, one edge, the edges of one face, all six. Two marks
/// on a face become three, anything else six.
inline constexpr auto legal_mask = detail::make_legal_masks();

/// State of a legal mask, -1 for others; all six marks give the state of diagonal 0, to which the diagonal is added.
inline constexpr auto state_of_mask = detail::make_states();

/// State by which a family was made.
constexpr int state_of_family(mesh::Lineage lineage) {
  switch (lineage.kind()) {
    case mesh::FamilyKind::edge:
      return 1 + lineage.index();
    case mesh::FamilyKind::face:
      return 7 + lineage.index();
    default:
      return 0;
  }
}

}  // namespace pamr::refine
