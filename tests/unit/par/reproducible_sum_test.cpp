// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/reproducible_sum.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <limits>
#include <random>

namespace pamr::par {
namespace reproducible_sum_test {

constexpr double largest = std::numeric_limits<double>::max();
constexpr double smallest = std::numeric_limits<double>::denorm_min();

double exact(std::vector<double> values) {
  ExactSum sum;
  for (const double v : values) sum.add(v);
  return sum.value();
}

TEST(ExactSum, OfNothingIsZero) { EXPECT_EQ(ExactSum().value(), 0.0); }

TEST(ExactSum, OfOneValueIsThatValue) {
  for (const double v : {1.0, -1.0, 0.1, -3e300, 1e-310, smallest, -smallest, largest, -largest, 4503599627370497.0})
    EXPECT_EQ(exact({v}), v);
}

TEST(ExactSum, KeepsWhatRoundingWouldLose) {
  EXPECT_EQ(exact({1e300, 1.0, -1e300}), 1.0);
  EXPECT_EQ(exact({largest, largest, -largest, smallest, -largest}), smallest);
  EXPECT_EQ(exact({0.1, 0.2, -0.3}), 0x1p-55);  // the three nearest doubles differ from 1/10, 2/10, 3/10
}

TEST(ExactSum, RoundsTiesToEven) {
  EXPECT_EQ(exact({1.0, 0x1p-53}), 1.0);
  EXPECT_EQ(exact({1.0, 0x1p-53, smallest}), 1.0 + 0x1p-52);
  EXPECT_EQ(exact({1.0 + 0x1p-52, 0x1p-53}), 1.0 + 0x1p-51);
  EXPECT_EQ(exact({-1.0, -0x1p-53, -smallest}), -1.0 - 0x1p-52);
}

TEST(ExactSum, OverflowsOnlyWhenTheTotalDoes) {
  EXPECT_EQ(exact({largest, largest}), std::numeric_limits<double>::infinity());
  EXPECT_EQ(exact({-largest, -largest}), -std::numeric_limits<double>::infinity());
}

TEST(ExactSum, TreatsInfinitiesAndNotANumberAsAddition) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  EXPECT_EQ(exact({infinity, 1.0}), infinity);
  EXPECT_EQ(exact({-infinity, 1.0}), -infinity);
  EXPECT_TRUE(std::isnan(exact({infinity, -infinity})));
  EXPECT_TRUE(std::isnan(exact({std::nan(""), 1.0})));
}

TEST(ExactSum, AgreesWithExtendedIntegersOnRandomValues) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 200; ++round) {
    __extension__ __int128 twin = 0;  // in units of 2^-40
    ExactSum sum;
    for (int i = 0; i < 500; ++i) {
      const auto units = static_cast<std::int64_t>(random() >> 11U) - (std::int64_t{1} << 52);
      sum.add(std::ldexp(static_cast<double>(units), -40));
      twin += units;
    }
    EXPECT_EQ(sum.value(), std::ldexp(static_cast<double>(twin), -40));
  }
}

TEST(ExactSum, HoldsThousandsOfValuesOfOneSizeWhateverItIs) {
  constexpr int n = 9000, n_exponents = 64;  // two digits of the sum
  constexpr std::int64_t units = (std::int64_t{1} << 53) - 1;
  __extension__ const auto all = static_cast<__int128>(units) * n;
  for (int exponent = 0; exponent < n_exponents; ++exponent) {
    const double value = std::ldexp(static_cast<double>(units), exponent);
    ExactSum sum;
    for (int i = 0; i < n; ++i) sum.add(value);
    EXPECT_EQ(sum.value(), std::ldexp(static_cast<double>(all), exponent));
  }
}

TEST(ReproducibleSum, HasTheSameBitsForEveryOrderAndEveryPartition) {
  Comm comm(MPI_COMM_WORLD);
  std::mt19937_64 random(11);
  std::vector<double> all(1000);
  for (auto& v : all)
    v = std::ldexp(static_cast<double>(random()), static_cast<int>(random() % 200) - 100) *
        ((random() & 1U) != 0 ? 1.0 : -1.0);
  const double expected = exact(all);

  for (int round = 0; round < 5; ++round) {
    std::shuffle(all.begin(), all.end(), random);
    std::vector<double> mine;
    for (const double v : all)
      if (static_cast<Rank>(random() % static_cast<std::uint64_t>(comm.size())) == comm.rank()) mine.push_back(v);
    EXPECT_EQ(std::bit_cast<std::uint64_t>(reproducible_sum(comm, mine)), std::bit_cast<std::uint64_t>(expected));
  }
}

TEST(ReproducibleSum, AddsSeveralSumsAtOnce) {
  Comm comm(MPI_COMM_WORLD);
  std::vector<ExactSum> sums(3);
  sums[0].add(1.0);
  if (comm.is_first()) {
    sums[2].add(1e200);
    sums[2].add(-1e200);
  } else {
    sums[2].add(1.0);
  }

  const auto total = reproducible_sums(comm, sums);

  EXPECT_EQ(total, (std::vector<double>{static_cast<double>(comm.size()), 0.0, comm.size() - 1.0}));
}

}  // namespace reproducible_sum_test
}  // namespace pamr::par
