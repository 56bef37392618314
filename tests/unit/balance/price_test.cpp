// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/price.hpp"

#include <gtest/gtest.h>

#include <array>

namespace pamr {
namespace price_test {

using balance::Method;
using balance::Quality;

TEST(Price, KnowsTheFacesBetweenTheEighthsOfACube) {
  std::array<std::int64_t, 8> cells{};
  cells.fill(6 * 10 * 10 * 10);

  // three planes of 20 x 20 squares, two faces each
  EXPECT_NEAR(balance::faces_between_compact_parts(cells), 3 * 2 * 20 * 20, 0.03 * 3 * 2 * 20 * 20);
  EXPECT_EQ(balance::faces_between_compact_parts(std::array<std::int64_t, 3>{0, 500, 0}), 0);
}

TEST(Price, AsksForBothEvenPartsAndFewFaces) {
  const balance::Options how{.method = Method::best, .keep_below = 1.05};
  Quality quality{.imbalance = 1.04, .edge_cut = 150, .compact_cut = 100};
  EXPECT_TRUE(balance::meets(quality, how));

  quality.edge_cut = 151;
  EXPECT_FALSE(balance::meets(quality, how));
  EXPECT_TRUE(balance::meets(quality, {.method = Method::blocks, .keep_below = 1.05}));

  quality = {.imbalance = 1.06, .edge_cut = 1, .compact_cut = 100};
  EXPECT_FALSE(balance::meets(quality, how));
}

TEST(Price, MovesCellsForAHundredthAndForWhatMeetsTheBars) {
  const balance::Options how{.method = Method::best, .keep_below = 1.05};
  const balance::Size size{8000, 8};
  const Quality before{.imbalance = 1.2, .edge_cut = 400, .compact_cut = 100};  // a pass: 1,200 + 100

  EXPECT_FALSE(balance::is_gain(before, before, size, how));
  EXPECT_FALSE(balance::is_gain(before, {.imbalance = 1.19, .edge_cut = 396, .compact_cut = 100}, size, how));
  EXPECT_TRUE(balance::is_gain(before, {.imbalance = 1.187, .edge_cut = 400, .compact_cut = 100}, size, how));
  EXPECT_TRUE(balance::is_gain(before, {.imbalance = 1.2, .edge_cut = 340, .compact_cut = 100}, size, how));
  EXPECT_TRUE(balance::is_gain({.imbalance = 1, .edge_cut = 151, .compact_cut = 100},
                               {.imbalance = 1.05, .edge_cut = 150, .compact_cut = 100}, size, how));
}

TEST(Price, RepaysScotchOverManyPassesOnly) {
  const balance::Size size{800000, 8};
  const Quality curve{.imbalance = 1, .edge_cut = 20000, .compact_cut = 15000};

  balance::Options how;
  EXPECT_LT(how.passes * balance::work_of_pass(curve, size), balance::work_with_scotch(size, how));
  how.passes = 1e6;
  EXPECT_GT(how.passes * balance::work_of_pass({.imbalance = 1.02, .edge_cut = 20000, .compact_cut = 15000}, size),
            balance::work_with_scotch(size, how));
}

}  // namespace price_test
}  // namespace pamr
