// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/hash.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <set>

namespace pamr {
namespace hash_test {

TEST(Mix, AgreesWithTheFirstOutputsOfSplitmix64) {
  // Splitmix64 seeded with 0: the state grows by the golden gamma before each output.
  EXPECT_EQ(mix(0), 0xe220a8397b1dcdafU);
  EXPECT_EQ(mix(0x9e3779b97f4a7c15U), 0x6e789e6aa1b965f4U);
}

TEST(Mix, GivesDistinctValuesForNeighboringWords) {
  std::set<std::uint64_t> values;

  for (std::uint64_t i = 0; i < 10000; ++i) values.insert(mix(i));

  EXPECT_EQ(values.size(), 10000U);
}

TEST(Combine, DependsOnTheOrderOfTheWords) { EXPECT_NE(combine(combine(1, 2), 3), combine(combine(1, 3), 2)); }

TEST(Combine, DependsOnTheSeed) { EXPECT_NE(combine(1, 7), combine(2, 7)); }

TEST(BitsOf, FoldsMinusZeroOntoPlusZero) { EXPECT_EQ(bits_of(-0.0), bits_of(0.0)); }

TEST(BitsOf, TellsNeighboringDoublesApart) { EXPECT_NE(bits_of(1.0), bits_of(1.0 + 0x1p-52)); }

}  // namespace hash_test
}  // namespace pamr
