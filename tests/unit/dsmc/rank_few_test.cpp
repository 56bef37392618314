// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/rank_few.hpp"

#include <gtest/gtest.h>

#include <array>
#include <set>
#include <vector>

#include "support/dice.hpp"

namespace pamr::dsmc {
namespace rank_few_test {

void expect_ranked(const std::vector<std::uint64_t>& numbers) {
  std::array<std::uint32_t, max_few> rank{};
  rank_few(numbers, rank);
  for (std::size_t k = 0; k < numbers.size(); ++k) {
    std::uint32_t before = 0;
    for (std::size_t j = 0; j < numbers.size(); ++j)
      before += numbers[j] < numbers[k] || (numbers[j] == numbers[k] && j < k) ? 1 : 0;
    EXPECT_EQ(rank[k], before) << "number " << numbers[k] << ", " << k << " of " << numbers.size();
  }
}

TEST(RankFew, KeepsEqualNumbersInTheirOrder) {
  test::Dice dice(6);
  for (std::size_t n = 0; n <= max_few; ++n)
    for (const std::size_t n_different : {1, 3, 20})
      for (const std::uint64_t high : {0, 1}) {  // also where the upper halves differ
        std::vector<std::uint64_t> numbers(n);
        for (auto& number : numbers) number = dice.below(n_different) | high * dice.below(2) << 63U;
        expect_ranked(numbers);
      }
}

TEST(RankFew, SortsAnyNumberOfThem) {
  // Halves at the ends of their range and on both sides of the sign, which compare wrongly when taken as signed ones.
  const std::vector<std::uint64_t> halves{0,          1,          2,          0x7ffffffe, 0x7fffffff,
                                          0x80000000, 0x80000001, 0xfffffffe, 0xffffffff};
  test::Dice dice(5);
  for (const std::size_t n_high : {1, 2, 9})  // those of one have all the same upper half
    for (std::size_t n = 0; n <= max_few; ++n) {
      const auto start = dice.below(halves.size());
      std::set<std::uint64_t> different;
      while (different.size() < n) {
        const auto high = halves[(start + dice.below(n_high)) % halves.size()];
        const auto low = dice.below(2) == 0 ? halves[dice.below(halves.size())] : dice.below(1U << 31U) * 2;
        different.insert(high << 32U | low);
      }
      std::vector<std::uint64_t> numbers(different.begin(), different.end());
      dice.shuffle(numbers);
      expect_ranked(numbers);
    }
}

}  // namespace rank_few_test
}  // namespace pamr::dsmc
