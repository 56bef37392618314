// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/order/hilbert.hpp"

#include <gtest/gtest.h>

#include <cstdlib>
#include <limits>
#include <map>
#include <random>

namespace pamr::order {
namespace hilbert_test {

using Grid = std::array<std::uint32_t, 3>;

/// Skilling's program as it was published: bit by bit.
std::uint64_t skilling(Grid x) {
  constexpr unsigned n_bits = 21;
  for (std::uint32_t q = 1U << (n_bits - 1); q > 1; q >>= 1U)
    for (auto& coordinate : x) {
      if ((coordinate & q) != 0) {
        x[0] ^= q - 1;
      } else {
        const std::uint32_t t = (x[0] ^ coordinate) & (q - 1);
        x[0] ^= t;
        coordinate ^= t;
      }
    }
  x[1] ^= x[0];
  x[2] ^= x[1];
  std::uint32_t t = 0;
  for (std::uint32_t q = 1U << (n_bits - 1); q > 1; q >>= 1U)
    if ((x[2] & q) != 0) t ^= q - 1;
  std::uint64_t key = 0;
  for (unsigned bit = n_bits; bit-- > 0;)
    for (const auto coordinate : x) key = key << 1U | ((coordinate ^ t) >> bit & 1U);
  return key;
}

TEST(HilbertKey, PassesEveryPointOfACubeOnceInUnitSteps) {
  std::map<std::uint64_t, Grid> along;
  for (std::uint32_t x = 0; x < 16; ++x)
    for (std::uint32_t y = 0; y < 16; ++y)
      for (std::uint32_t z = 0; z < 16; ++z) along[hilbert_key({x, y, z})] = {x, y, z};

  ASSERT_EQ(along.size(), 4096U);
  EXPECT_EQ(along.begin()->first, 0U);
  EXPECT_EQ(along.rbegin()->first, 4095U);
  for (auto next = std::next(along.begin()), here = along.begin(); next != along.end(); ++next, ++here) {
    int steps = 0;
    for (std::size_t i = 0; i < 3; ++i)
      steps += std::abs(static_cast<int>(next->second[i]) - static_cast<int>(here->second[i]));
    EXPECT_EQ(steps, 1) << "after key " << here->first;
  }
}

TEST(HilbertKey, UsesAll63Bits) { EXPECT_EQ(hilbert_key({(1U << 21U) - 1, 0, 0}), (std::uint64_t{1} << 63U) - 1); }

TEST(HilbertKey, IsSkillingsOnRandomPoints) {
  std::mt19937 engine(3);
  for (int i = 0; i < 100000; ++i) {
    Grid x{};
    for (auto& coordinate : x) coordinate = static_cast<std::uint32_t>(engine()) >> 11U;
    ASSERT_EQ(hilbert_key(x), skilling(x)) << x[0] << ' ' << x[1] << ' ' << x[2];
  }
}

TEST(CurveGrid, SpansTheLongestSideOfTheBox) {
  const CurveGrid grid({{1, 2, 3}, {3, 3, 3.5}});

  EXPECT_EQ(grid.key({1, 2, 3}), 0U);
  EXPECT_EQ(grid.key({3, 2, 3}), (std::uint64_t{1} << 63U) - 1);
  EXPECT_EQ(grid.key({2, 3, 3}), hilbert_key({(1U << 20U) - 1, (1U << 20U) - 1, 0}));
}

TEST(CurveGrid, PutsWhatIsNoPointOfTheBoxSomewhere) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  const auto nan = std::numeric_limits<double>::quiet_NaN();
  const CurveGrid grid({{0, 0, 0}, {1, 1, 1}}), empty(geometry::Box{});

  EXPECT_EQ(grid.key({nan, nan, nan}), 0U);
  EXPECT_EQ(grid.key({infinity, -1, -infinity}), (std::uint64_t{1} << 63U) - 1);
  EXPECT_EQ(empty.key({0.5, 0.5, 0.5}), 0U);
  EXPECT_EQ(CurveGrid({{1, 1, 1}, {1, 1, 1}}).key({1, 1, 1}), 0U);
}

}  // namespace hilbert_test
}  // namespace pamr::order
