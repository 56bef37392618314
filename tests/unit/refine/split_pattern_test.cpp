// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/split_pattern.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <map>
#include <set>

#include "pamr/refine/family.hpp"

namespace pamr::refine {
namespace split_pattern_test {

using Codes = std::array<std::int8_t, 4>;
using Triangle = std::set<int>;

/// Twice the corners of a tetrahedron in general position, so that midpoints are whole numbers.
constexpr std::array<std::array<long, 3>, 4> corners{{{0, 0, 0}, {38, 4, 10}, {6, 58, -2}, {-14, 10, 46}}};

std::array<long, 3> position(int code) {
  if (code < 4) return corners[at(code)];
  const auto [a, b] = mesh::tet::edge_to_corner[at(code - 4)];
  std::array<long, 3> p{};
  for (std::size_t k = 0; k < 3; ++k) p[k] = (corners[at(a)][k] + corners[at(b)][k]) / 2;
  return p;
}

/// Six volumes, exactly.
long volume(const Codes& nodes) {
  std::array<std::array<long, 3>, 3> d{};
  const auto o = position(nodes[0]);
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t k = 0; k < 3; ++k) d[i][k] = position(nodes[i + 1])[k] - o[k];
  return d[0][0] * (d[1][1] * d[2][2] - d[1][2] * d[2][1]) - d[0][1] * (d[1][0] * d[2][2] - d[1][2] * d[2][0]) +
         d[0][2] * (d[1][0] * d[2][1] - d[1][1] * d[2][0]);
}

Triangle triangle_of(const Codes& nodes, int slot) {
  Triangle triangle;
  for (int i = 0; i < 4; ++i)
    if (i != slot) triangle.insert(nodes[at(i)]);
  return triangle;
}

bool lies_on(int code, int face) {
  return code < 4 ? code != face : (mesh::tet::face_edge_mask[at(face)] >> (code - 4) & 1) != 0;
}

/// The triangles of a face with these marks, from the rules in docs/refinement.md.
std::set<Triangle> face_triangles(int face, unsigned mask, bool is_cut_from_higher) {
  std::vector<int> corner, marked;
  for (int c = 0; c < 4; ++c)
    if (c != face) corner.push_back(c);
  for (int e = 0; e < 6; ++e)
    if ((mask & mesh::tet::face_edge_mask[at(face)]) >> e & 1U) marked.push_back(e);
  const auto ends = [](int e) { return mesh::tet::edge_to_corner[at(e)]; };
  const auto third = [&](int e) { return corner[0] + corner[1] + corner[2] - ends(e)[0] - ends(e)[1]; };
  if (marked.empty()) return {{corner[0], corner[1], corner[2]}};
  if (marked.size() == 3) {
    std::set<Triangle> parts{{4 + marked[0], 4 + marked[1], 4 + marked[2]}};
    for (const int c : corner) {
      Triangle part{c};
      for (const int e : marked)
        if (ends(e)[0] == c || ends(e)[1] == c) part.insert(4 + e);
      parts.insert(part);
    }
    return parts;
  }
  const int cut = marked[marked.size() == 2 && is_cut_from_higher ? 1 : 0];
  std::set<Triangle> parts;
  for (const int end : ends(cut)) {
    const int other = marked.size() == 1 ? -1 : marked[0] + marked[1] - cut;
    if (other >= 0 && (ends(other)[0] == end || ends(other)[1] == end)) {
      parts.insert({end, 4 + cut, 4 + other});
      parts.insert({4 + cut, 4 + other, third(cut)});
    } else {
      parts.insert({end, 4 + cut, third(cut)});
    }
  }
  return parts;
}

TEST(SplitPattern, EveryStateIsAConformingTriangulationOfPositiveCells) {
  const long whole_volume = volume({0, 1, 2, 3});
  for (int s = 0; s < n_states; ++s) {
    SCOPED_TRACE(s);
    const auto& p = split_pattern[at(s)];
    std::map<Triangle, std::vector<long>> sides;  // of each triangle the signed volumes of the cells at it
    std::set<int> nodes;
    long sum = 0;
    for (int c = 0; c < p.n_children; ++c) {
      const auto& child = p.child_to_node[at(c)];
      EXPECT_GT(volume(child), 0);
      sum += volume(child);
      nodes.insert(child.begin(), child.end());
      for (int slot = 0; slot < 4; ++slot) {
        const auto triangle = triangle_of(child, slot);
        const std::vector<int> t(triangle.begin(), triangle.end());
        sides[triangle].push_back(volume({static_cast<std::int8_t>(t[0]), static_cast<std::int8_t>(t[1]),
                                          static_cast<std::int8_t>(t[2]), child[at(slot)]}));
      }
    }
    EXPECT_EQ(sum, whole_volume);
    std::set<int> expected_nodes{0, 1, 2, 3};
    for (int e = 0; e < 6; ++e)
      if ((p.mask >> e & 1) != 0) expected_nodes.insert(4 + e);
    EXPECT_EQ(nodes, expected_nodes);
    std::set<Triangle> outside;
    for (const auto& [triangle, volumes] : sides) {
      ASSERT_LE(volumes.size(), 2U);
      if (volumes.size() == 2) {  // the two cells lie on either side, so they do not overlap there
        EXPECT_LT(std::min(volumes[0], volumes[1]), 0);
        EXPECT_GT(std::max(volumes[0], volumes[1]), 0);
      }
      if (volumes.size() == 1) outside.insert(triangle);
    }
    std::set<Triangle> boundary;
    for (int f = 0; f < 4; ++f) boundary.merge(face_triangles(f, p.mask, (p.cuts >> f & 1) != 0));
    EXPECT_EQ(outside, boundary);
  }
}

TEST(SplitPattern, StatesOfTheSameMarksAndCutsDifferInTheirInnerEdge) {
  std::set<std::array<int, 3>> seen;
  int n_two = 0;
  for (unsigned mask = 1; mask < all_edges; ++mask)
    for (unsigned cuts = 0; cuts < 16; ++cuts) {
      const auto& choice = states_of_marks[mask][cuts].state;
      for (const int s : choice) {
        if (s == 0) continue;
        const auto& state = mesh::closure_states[at(s)];
        EXPECT_EQ(state.mask, mask);
        EXPECT_EQ(state.cuts, cuts);
        EXPECT_TRUE(seen.insert({static_cast<int>(mask), static_cast<int>(cuts), state.inner_edge}).second);
      }
      n_two += choice[1] != 0 ? 1 : 0;
      if (choice[1] != 0) {
        EXPECT_LT(mesh::closure_states[choice[0]].inner_edge, mesh::closure_states[choice[1]].inner_edge);
      }
    }
  EXPECT_EQ(seen.size(), 271U);
  EXPECT_EQ(n_two, 48);
}

/// Cuts that follow from some order of the edges.
std::set<unsigned> cuts_of_orders(unsigned mask) {
  std::set<unsigned> found;
  std::array<int, 6> rank{0, 1, 2, 3, 4, 5};
  do {
    unsigned cuts = 0;
    for (int f = 0; f < 4; ++f) {
      const unsigned two = mask & mesh::tet::face_edge_mask[at(f)];
      if (std::popcount(two) != 2) continue;
      const auto low = at(std::countr_zero(two)), high = at(std::countr_zero(two & (two - 1)));
      if (rank[high] > rank[low]) cuts |= 1U << f;
    }
    found.insert(cuts);
  } while (std::next_permutation(rank.begin(), rank.end()));
  return found;
}

TEST(SplitPattern, ThereIsAStateForAllMarksAndAllCutsThatAnOrderOfTheEdgesGives) {
  for (unsigned mask = 1; mask < all_edges; ++mask)
    for (unsigned cuts = 0; cuts < 16; ++cuts)
      EXPECT_EQ(states_of_marks[mask][cuts].state[0] != 0, cuts_of_orders(mask).count(cuts) == 1)
          << "marks " << mask << " cuts " << cuts;
}

TEST(SplitPattern, SiblingsPointBackAtEachOtherAndSeeTheSameCorners) {
  for (int s = 0; s < n_states; ++s) {
    const auto& p = split_pattern[at(s)];
    for (int c = 0; c < p.n_children; ++c)
      for (int f = 0; f < 4; ++f) {
        const int other = p.child_to_child[at(c)][at(f)];
        if (other < 0) continue;
        const auto& seen = sibling_face[at(s)][at(c)][at(f)];
        EXPECT_EQ(p.child_to_child[at(other)][at(seen.face)], c);
        EXPECT_EQ(triangle_of(p.child_to_node[at(c)], f), triangle_of(p.child_to_node[at(other)], seen.face));
        for (int i = 0; i < 4; ++i)
          if (i != f) {
            EXPECT_EQ(p.child_to_node[at(c)][at(i)], p.child_to_node[at(other)][at(seen.corner[at(i)])]);
          }
      }
  }
}

TEST(SplitPattern, OuterFacesAndTheirTablesAgree) {
  for (const auto& p : split_pattern)
    for (int f = 0; f < 4; ++f) {
      int n_parts = 0;
      for (int place = 0; place < n_places; ++place) {
        const int child = p.face_to_child[at(f)][at(place)];
        if (child < 0) continue;
        ++n_parts;
        const int slot = p.face_to_slot[at(f)][at(place)];
        EXPECT_EQ(p.child_to_child[at(child)][at(slot)], -(1 + f * n_places + place));
        for (const int code : triangle_of(p.child_to_node[at(child)], slot)) EXPECT_TRUE(lies_on(code, f));
      }
      EXPECT_EQ(n_parts, 1 + n_face_marks[p.mask][at(f)]);
    }
}

/// The part of a face at a place: its nodes by what both sides know, the corner itself or an edge by its two corners.
std::set<std::set<int>> part_at(const SplitPattern& p, int face, int place) {
  std::set<std::set<int>> part;
  const int child = p.face_to_child[at(face)][at(place)];
  if (child < 0) return part;
  for (const int code : triangle_of(p.child_to_node[at(child)], p.face_to_slot[at(face)][at(place)])) {
    if (code < 4)
      part.insert({code});
    else
      part.insert({mesh::tet::edge_to_corner[at(code - 4)][0], mesh::tet::edge_to_corner[at(code - 4)][1]});
  }
  return part;
}

TEST(SplitPattern, AFaceHasTheSamePartsAtTheSamePlacesInAllStatesWithItsMarksAndCut) {
  for (int f = 0; f < 4; ++f) {
    std::map<std::array<unsigned, 2>, const SplitPattern*> first;
    for (const auto& p : split_pattern) {
      const std::array<unsigned, 2> key{static_cast<unsigned>(p.mask & mesh::tet::face_edge_mask[at(f)]),
                                        p.cuts >> f & 1U};
      const auto* reference = first.emplace(key, &p).first->second;
      for (int place = 0; place < n_places; ++place) EXPECT_EQ(part_at(p, f, place), part_at(*reference, f, place));
    }
  }
}

TEST(FamilyTable, MembersHaveAllNodesAndKnowTheCutFaces) {
  for (int s = 1; s < regular_state; ++s) {
    const auto& table = family_table[at(s)];
    const auto& p = split_pattern[at(s)];
    for (int code = 0; code < 10; ++code) {
      const bool is_there = code < 4 || (p.mask >> (code - 4) & 1) != 0;
      ASSERT_EQ(table.node[at(code)].member >= 0, is_there);
      if (is_there) {
        EXPECT_EQ(p.child_to_node[at(table.node[at(code)].member)][at(table.node[at(code)].slot)], code);
      }
    }
    unsigned of_parent = p.mask;
    for (int c = 0; c < p.n_children; ++c) {
      of_parent |= marks_for_parent(s, c, table.edges_of_parent[at(c)]);
      for (int slot = 0; slot < 4; ++slot) {
        const int link = p.child_to_child[at(c)][at(slot)];
        const int n = link >= 0 ? 0 : n_face_marks[p.mask][at(outer_face(link))];
        EXPECT_EQ((table.cut_slots[at(c)] >> slot & 1) != 0, n == 1 || n == 2);
      }
    }
    EXPECT_EQ(of_parent, all_edges) << "state " << s;
  }
}

TEST(TemplateMask, IsTheSmallestSetWithATemplateThatHoldsTheMarks) {
  for (int m = 0; m < 64; ++m) {
    const int grown = template_mask[at(m)];
    EXPECT_EQ(grown & m, m);
    ASSERT_GE(state_of_template[at(grown)], 0);
    for (int other = 0; other < 64; ++other)
      if (state_of_template[at(other)] >= 0 && (other & m) == m) {
        EXPECT_LE(std::popcount(static_cast<unsigned>(grown)), std::popcount(static_cast<unsigned>(other)));
        EXPECT_EQ(template_mask[at(other)] & grown, grown);
      }
  }
}

}  // namespace split_pattern_test
}  // namespace pamr::refine
