// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/split_pattern.hpp"

#include <bit>

namespace pamr::refine {

namespace {

using mesh::tet::edge_to_corner;
using mesh::tet::face_edge_mask;

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
    add(edge_to_corner[at(code - 4)][0]);
    add(edge_to_corner[at(code - 4)][1]);
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

/// Corner children 0..3, then the four cells around the diagonal: each holds its two ends and one edge of the ring of
/// the other four midpoints.
constexpr void split_all(SplitPattern& p, int diagonal) {
  for (int own = 0; own < 4; ++own) {
    std::array<std::int8_t, 4> corner{};
    for (int slot = 0; slot < 4; ++slot) corner[at(slot)] = to_code(slot == own ? own : midpoint_code(own, slot));
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

/// Bit f: the node lies on face f.
constexpr auto make_faces_of_code() {
  std::array<std::uint8_t, 10> faces{};
  for (int code = 0; code < 10; ++code)
    for (int f = 0; f < 4; ++f)
      if (code < 4 ? code != f : (face_edge_mask[at(f)] >> (code - 4) & 1) != 0)
        faces[at(code)] = static_cast<std::uint8_t>(faces[at(code)] | 1U << f);
  return faces;
}
constexpr auto faces_of_code = make_faces_of_code();

/// Place of the triangle that a child shows on a face of its parent. `corners`: bits of the parent's corners in it.
constexpr int place_on_face(const SplitPattern& p, unsigned corners, int face) {
  const unsigned marks = p.mask & face_edge_mask[at(face)];
  const int n_marks = std::popcount(marks);
  if (n_marks == 0) return whole;
  if (n_marks == 3) return corners == 0 ? center : std::countr_zero(corners);
  const int lower = std::countr_zero(marks), higher = std::bit_width(marks) - 1;
  const int cut = (p.cuts >> face & 1) != 0 ? higher : lower;
  // the part that keeps two corners holds an end of the edge that the face is cut from, which names it
  for (const int end : edge_to_corner[at(cut)])
    if ((corners >> end & 1) != 0) return end;
  return std::countr_zero(corners);
}

constexpr unsigned codes_without(const std::array<std::int8_t, 4>& nodes, int slot) {
  unsigned codes = 0;
  for (int i = 0; i < 4; ++i)
    if (i != slot) codes |= 1U << nodes[at(i)];
  return codes;
}

constexpr void link(SplitPattern& p) {
  for (auto& face : p.face_to_child) face.fill(-1);
  for (auto& face : p.face_to_slot) face.fill(-1);
  std::array<std::array<unsigned, 4>, max_children> triangle{};
  for (int c = 0; c < p.n_children; ++c)
    for (int s = 0; s < 4; ++s) triangle[at(c)][at(s)] = codes_without(p.child_to_node[at(c)], s);
  for (int c = 0; c < p.n_children; ++c)
    for (int s = 0; s < 4; ++s) {
      const unsigned codes = triangle[at(c)][at(s)];
      auto& link = p.child_to_child[at(c)][at(s)];
      unsigned on = 0xf;
      for (unsigned rest = codes; rest != 0; rest &= rest - 1) on &= faces_of_code[at(std::countr_zero(rest))];
      if (on != 0) {
        const int face = std::countr_zero(on), place = place_on_face(p, codes & 0xfU, face);
        link = to_code(-(1 + face * n_places + place));
        p.face_to_child[at(face)][at(place)] = to_code(c);
        p.face_to_slot[at(face)][at(place)] = to_code(s);
        continue;
      }
      for (int other = 0; other < p.n_children; ++other)
        for (int t = 0; t < 4; ++t)
          if (other != c && triangle[at(other)][at(t)] == codes) link = to_code(other);
    }
}

constexpr std::array<SplitPattern, n_states> make_patterns() {
  std::array<SplitPattern, n_states> patterns{};
  for (int s = 0; s < regular_state; ++s) {
    const auto& state = mesh::closure_states[at(s)];
    auto& p = patterns[at(s)];
    p.mask = state.mask;
    p.cuts = state.cuts;
    for (int child = 0; child < state.family.n_children; ++child) add_child(p, state.family.child_to_node[at(child)]);
  }
  for (int d = 0; d < 3; ++d) {
    patterns[at(regular_state + d)].mask = all_edges;
    split_all(patterns[at(regular_state + d)], d);
  }
  for (auto& p : patterns) link(p);
  return patterns;
}

constexpr auto make_sibling_faces(const std::array<SplitPattern, n_states>& patterns) {
  std::array<std::array<std::array<SiblingFace, 4>, max_children>, n_states> table{};
  for (int s = 1; s < n_states; ++s) {
    const auto& pattern = patterns[at(s)];
    for (int c = 0; c < pattern.n_children; ++c)
      for (int f = 0; f < 4; ++f) {
        const int sibling = pattern.child_to_child[at(c)][at(f)];
        if (sibling < 0) continue;
        auto& face = table[at(s)][at(c)][at(f)];
        for (int there = 0; there < 4; ++there) {
          if (pattern.child_to_child[at(sibling)][at(there)] == c) face.face = to_code(there);
          for (int here = 0; here < 4; ++here)
            if (pattern.child_to_node[at(c)][at(here)] == pattern.child_to_node[at(sibling)][at(there)])
              face.corner[at(here)] = to_code(there);
        }
      }
  }
  return table;
}

constexpr auto make_face_marks() {
  std::array<std::array<std::uint8_t, 4>, 64> table{};
  for (unsigned mask = 0; mask < 64; ++mask)
    for (int f = 0; f < 4; ++f)
      table[mask][at(f)] = static_cast<std::uint8_t>(std::popcount(mask & face_edge_mask[at(f)]));
  return table;
}

constexpr auto make_states_of_marks() {
  std::array<std::array<StateChoice, 16>, 64> table{};
  for (int s = 1; s < regular_state; ++s) {
    const auto& state = mesh::closure_states[at(s)];
    auto& choice = table[state.mask][state.cuts].state;
    choice[choice[0] == 0 ? 0 : 1] = static_cast<SplitState>(s);
  }
  return table;
}

constexpr std::array<EdgeMask, 64> make_template_masks() {
  std::array<EdgeMask, 64> table{};
  for (unsigned mask = 0; mask < 64; ++mask) {
    table[mask] = std::popcount(mask) <= 1 ? static_cast<EdgeMask>(mask) : all_edges;
    for (const auto face : face_edge_mask)
      if (std::popcount(mask) > 1 && (mask & ~static_cast<unsigned>(face)) == 0) table[mask] = face;
  }
  return table;
}

constexpr std::array<std::int16_t, 64> make_states_of_templates() {
  std::array<std::int16_t, 64> table{};
  table.fill(-1);
  for (int s = 0; s < 11; ++s) table[mesh::closure_states[at(s)].mask] = static_cast<std::int16_t>(s);
  table[all_edges] = regular_state;
  return table;
}

}  // namespace

constexpr std::array<SplitPattern, n_states> split_pattern = make_patterns();
constexpr std::array<std::array<std::array<SiblingFace, 4>, max_children>, n_states> sibling_face =
    make_sibling_faces(split_pattern);
constexpr std::array<std::array<std::uint8_t, 4>, 64> n_face_marks = make_face_marks();
constexpr std::array<std::array<StateChoice, 16>, 64> states_of_marks = make_states_of_marks();
constexpr std::array<EdgeMask, 64> template_mask = make_template_masks();
constexpr std::array<std::int16_t, 64> state_of_template = make_states_of_templates();

int child_volume(const std::array<std::int8_t, 4>& nodes) { return determinant(nodes); }

}  // namespace pamr::refine
