// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/split_pattern.hpp"

#include <gtest/gtest.h>

#include "pamr/refine/closure.hpp"

namespace pamr::refine {
namespace {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

TEST(SplitPattern, ChildrenAreOrientedAndFillTheParent) {
  for (int s = 0; s < n_states; ++s) {
    int sum = 0;
    for (int c = 0; c < split_pattern[at(s)].n_children; ++c) {
      const int d = detail::determinant(split_pattern[at(s)].child_to_node[at(c)]);
      EXPECT_GT(d, 0) << "state " << s << " child " << c;
      sum += d;
    }
    EXPECT_EQ(sum, 8) << "state " << s;  // coordinates are doubled
  }
}

TEST(SplitPattern, NumbersOfChildrenFollowTheMarks) {
  for (int s = 0; s < n_states; ++s) {
    const auto& p = split_pattern[at(s)];
    EXPECT_EQ(p.n_children, p.mask == 0 ? 1 : p.mask == all_edges ? 8 : std::popcount(p.mask) == 1 ? 2 : 4);
  }
}

TEST(SplitPattern, SiblingsPointBackAtEachOther) {
  for (const auto& p : split_pattern)
    for (int c = 0; c < p.n_children; ++c)
      for (int s = 0; s < 4; ++s) {
        const int other = p.child_to_child[at(c)][at(s)];
        if (other < 0) continue;
        const auto& back = p.child_to_child[at(other)];
        EXPECT_EQ(std::count(back.begin(), back.end(), c), 1);
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
        EXPECT_EQ(p.child_to_child[at(child)][at(p.face_to_slot[at(f)][at(place)])], -(1 + f * n_places + place));
      }
      const int n_marks = std::popcount(static_cast<unsigned>(p.mask & mesh::tet::face_edge_mask[at(f)]));
      EXPECT_EQ(n_parts, n_marks == 0 ? 1 : n_marks + 1);
    }
}

TEST(SplitPattern, AFaceSplitsTheSameWaySeenFromEitherSide) {
  // two cells that share face (a, b, c) with the same marks show parts with the same corners: the part kept at a corner
  // holds that corner and the midpoints next to it, whichever pattern it came from
  for (const auto& p : split_pattern)
    for (int f = 0; f < 4; ++f)
      for (int corner = 0; corner < 4; ++corner) {
        const int child = p.face_to_child[at(f)][at(corner)];
        if (child < 0) continue;
        const int slot = p.face_to_slot[at(f)][at(corner)];
        for (int i = 0; i < 4; ++i) {
          if (i == slot) continue;
          const int code = p.child_to_node[at(child)][at(i)];
          if (code < 4) continue;
          const auto [a, b] = mesh::tet::edge_to_corner[at(code - 4)];
          EXPECT_TRUE(a == corner || b == corner);
        }
      }
}

TEST(LegalMask, IsTheSmallestLegalSetThatHoldsTheMarks) {
  for (int m = 0; m < 64; ++m) {
    const int legal = legal_mask[at(m)];
    EXPECT_EQ(legal & m, m);
    ASSERT_GE(state_of_mask[at(legal)], 0);
    for (const auto& p : split_pattern)
      EXPECT_TRUE((p.mask & m) != m || std::popcount(static_cast<unsigned>(legal)) <= std::popcount(p.mask)) << m;
  }
}

TEST(LegalMask, IsMonotoneAndIdempotent) {
  for (int a = 0; a < 64; ++a) {
    EXPECT_EQ(legal_mask[legal_mask[at(a)]], legal_mask[at(a)]);
    for (int b = 0; b < 64; ++b)
      if ((a & b) == a) {
        EXPECT_EQ(legal_mask[at(a)] & legal_mask[at(b)], legal_mask[at(a)]) << a << " " << b;
      }
  }
}

}  // namespace
}  // namespace pamr::refine
