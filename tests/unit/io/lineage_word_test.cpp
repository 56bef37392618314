// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/native/lineage_word.hpp"

#include <gtest/gtest.h>

#include "pamr/io/native/format.hpp"

namespace pamr::io {
namespace lineage_word_test {

using mesh::Lineage;

TEST(LineageWord, OfFormatOneComesBackAsItWas) {
  int n_accepted = 0;
  for (std::uint64_t word = 0; word < 0x20000; ++word) {
    const auto lineage = lineage_of_word(1, word);
    if (!lineage) continue;
    ++n_accepted;
    ASSERT_TRUE(has_word(1, *lineage));
    ASSERT_EQ(word_of_lineage(1, *lineage), word);
    ASSERT_EQ(lineage->level(), static_cast<int>(word >> 8U));
    ASSERT_EQ(lineage->depth(), 0);
  }
  // regular cells, and the members of 6 families of two and 4 of four, whole and broken, of 256 levels
  EXPECT_EQ(n_accepted, 256 * (1 + 2 * (6 * 2 + 4 * 4)));
}

TEST(LineageWord, OfFormatOneIsWhatItsPageSays) {
  EXPECT_EQ(lineage_of_word(1, 0x0000), Lineage{});
  EXPECT_EQ(lineage_of_word(1, 0x0300), Lineage::regular(3));
  EXPECT_EQ(lineage_of_word(1, 0x0135), Lineage(mesh::FamilyKind::edge, 5, 1, 1));
  EXPECT_EQ(lineage_of_word(1, 0x026e), Lineage(mesh::FamilyKind::face, 3, 3, 2));
  EXPECT_EQ(lineage_of_word(1, 0x02ee), Lineage(mesh::FamilyKind::face, 3, 3, 2).broken());
}

TEST(LineageWord, OfFormatTwoIsTheWordInMemory) {
  const auto base = Lineage::regular(3).red_child(2).red_child(7);
  for (int state = 0; state < mesh::n_family_states; ++state)
    for (int child = 0; child < mesh::family_size_of_state[static_cast<std::size_t>(state)]; ++child) {
      const auto lineage = base.closed(state, child);
      EXPECT_EQ(word_of_lineage(2, lineage), lineage.bits());
      EXPECT_EQ(lineage_of_word(2, lineage.bits()), lineage);
    }
  EXPECT_EQ(lineage_of_word(2, static_cast<std::uint64_t>(mesh::n_family_codes)), std::nullopt);
  EXPECT_EQ(lineage_of_word(2, std::uint64_t{1} << 20U), std::nullopt);
}

TEST(LineageWord, OfFormatOneIsThereForTheOldStatesOnlyAndDropsThePath) {
  const auto base = Lineage::regular(0).red_child(2);
  for (int state = 0; state < mesh::n_family_states; ++state) {
    EXPECT_EQ(has_word(1, base.closed(state, 0)), state <= 10);
    EXPECT_TRUE(has_word(newest_format, base.closed(state, 0)));
  }
  EXPECT_EQ(word_of_lineage(1, base), 0x100U);
  EXPECT_EQ(word_of_lineage(1, base.closed(1, 1)), 0x121U);
}

}  // namespace lineage_word_test
}  // namespace pamr::io
