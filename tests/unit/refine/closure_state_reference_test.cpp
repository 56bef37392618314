// SPDX-License-Identifier: GPL-3.0-or-later
// The table of closure states against a search of its own.
#include <gtest/gtest.h>

#include <map>
#include <string>

#include "pamr/mesh/closure_state.hpp"
#include "pamr/mesh/tet.hpp"
#include "support/reference_patterns.hpp"

namespace pamr {
namespace closure_state_reference_test {

std::size_t at(int i) { return static_cast<std::size_t>(i); }

TEST(ReferencePatterns, AreThe275TriangulationsAndEachIsConforming) {
  std::map<std::size_t, int> count;
  for (const auto& pattern : test::all_patterns()) {
    ++count[pattern.child.size()];
    ASSERT_TRUE(test::is_conforming(pattern));
  }

  EXPECT_EQ(count, (std::map<std::size_t, int>{{1, 1}, {2, 6}, {3, 24}, {4, 43}, {5, 60}, {6, 102}, {7, 36}, {8, 3}}));
}

TEST(ReferencePatterns, AreFoundNotConformingWhenACellIsMissingOrTurnedOver) {
  for (const auto& pattern : test::all_patterns()) {
    auto without = pattern, inverted = pattern;
    without.child.pop_back();
    std::swap(inverted.child.front()[2], inverted.child.front()[3]);

    ASSERT_FALSE(test::is_conforming(without));
    ASSERT_FALSE(test::is_conforming(inverted));
  }
}

TEST(ReferencePatterns, HaveNoneWhereThreeCutsRunAroundACorner) {
  // the edges 0, 1 and 2 meet in corner 0; faces 3, 1 and 2 hold two of them each
  EXPECT_TRUE(test::patterns_of({0, 1, 2}, {{3, 0}, {1, 1}, {2, 2}}).empty());
  EXPECT_TRUE(test::patterns_of({0, 1, 2}, {{3, 1}, {1, 2}, {2, 0}}).empty());
  EXPECT_EQ(test::patterns_of({0, 1, 2}, {{3, 0}, {1, 1}, {2, 0}}).size(), 1U);
}

TEST(ClosureStates, AreThoseOfTheReferenceInItsOrder) {
  const auto& expected = test::family_patterns();

  ASSERT_EQ(mesh::closure_states.size(), expected.size());
  for (std::size_t s = 0; s < expected.size(); ++s) {
    SCOPED_TRACE("state " + std::to_string(s));
    const auto& state = mesh::closure_states[s];
    const auto& pattern = expected[s];
    EXPECT_EQ(test::state_of(pattern), static_cast<int>(s));
    for (int e = 0; e < 6; ++e) EXPECT_EQ((state.mask >> e & 1) != 0, pattern.marks.count(e) != 0);
    for (int face = 0; face < 4; ++face) {
      const auto cut = pattern.cut.find(face);
      const int two = state.mask & mesh::tet::face_edge_mask[at(face)];
      const bool from_larger = cut != pattern.cut.end() && two >> (cut->second + 1) == 0;
      EXPECT_EQ((state.cuts >> face & 1) != 0, from_larger) << "face " << face;
    }
    EXPECT_EQ(state.inner_edge, pattern.inner_edge);
    ASSERT_EQ(static_cast<std::size_t>(state.family.n_children), pattern.child.size());
    ASSERT_EQ(static_cast<std::size_t>(mesh::family_size_of_state[s]), pattern.child.size());
    for (std::size_t c = 0; c < pattern.child.size(); ++c)
      for (std::size_t i = 0; i < 4; ++i)
        EXPECT_EQ(static_cast<int>(state.family.child_to_node[c][i]), pattern.child[c][i]);
  }
}

}  // namespace closure_state_reference_test
}  // namespace pamr
