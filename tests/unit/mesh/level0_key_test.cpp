// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/level0_key.hpp"

#include <gtest/gtest.h>

#include <random>
#include <vector>

#include "pamr/mesh/level0_map.hpp"

namespace pamr {
namespace level0_key_test {

using mesh::Level0Key;
using mesh::middle;

TEST(Level0Key, OfAMiddleAddsWhatBothEndsHave) {
  const auto a = Level0Key::of_node(7), b = Level0Key::of_node(3);

  const auto ab = middle(a, b);
  const auto third = middle(ab, a);

  constexpr std::int64_t whole = std::int64_t{1} << 62;
  EXPECT_EQ(ab, (Level0Key{{3, 7, -1, -1}, {whole / 2, whole / 2, 0, 0}}));
  EXPECT_EQ(third, (Level0Key{{3, 7, -1, -1}, {whole / 4, 3 * (whole / 4), 0, 0}}));
  EXPECT_EQ(middle(b, a), ab);
  EXPECT_EQ(middle(a, a), a);
}

TEST(Level0Key, IsNotKnownBeyondFourNodesAnUnknownEndOrWhatCannotBeHalved) {
  auto key = Level0Key::of_node(0);
  for (GlobalId n = 1; n < 4; ++n) key = middle(key, Level0Key::of_node(n));
  EXPECT_TRUE(key.is_known());
  EXPECT_FALSE(middle(key, Level0Key::of_node(4)).is_known());
  EXPECT_FALSE(middle(key, {}).is_known());
  EXPECT_FALSE(middle({}, key).is_known());

  auto deep = middle(Level0Key::of_node(0), Level0Key::of_node(1));
  int n_halvings = 1;
  while (deep.is_known()) {
    EXPECT_EQ(deep.weight[0] + deep.weight[1], std::int64_t{1} << 62);
    deep = middle(deep, Level0Key::of_node(0));
    ++n_halvings;
  }
  EXPECT_EQ(n_halvings, 63);
}

/// Nodes of the cell again and again halfway to others, until weights cannot be halved.
TEST(Level0Key, HasTheMiddlesThatItsWeightsByTheCornersOfACellHave) {
  mesh::Level0Cell cell;
  cell.node = {8, 3, 9, 5};  // corners are in the order of coordinates, not of numbers
  const mesh::Level0Map map({cell}, 1, {});
  const auto weights = [&map](const Level0Key& key) { return map.weights(0, key); };
  std::vector<Level0Key> keys;
  for (const auto node : cell.node) keys.push_back(Level0Key::of_node(node));
  std::mt19937 random(1);
  int n_unknown = 0;
  for (int i = 0; i < 300; ++i) {
    const auto a = keys[random() % keys.size()], b = keys[keys.size() - 1 - random() % 4];
    keys.push_back(middle(a, b));
    EXPECT_EQ(weights(keys.back()), middle(weights(a), weights(b)));
    n_unknown += keys.back().is_known() ? 0 : 1;
  }

  EXPECT_EQ(weights(Level0Key::of_node(9)), (mesh::CornerWeights{0, 0, std::int64_t{1} << 62, 0}));
  EXPECT_EQ(weights(middle(Level0Key::of_node(9), Level0Key::of_node(4))), mesh::CornerWeights{});
  EXPECT_TRUE(0 < n_unknown && n_unknown < 300);
}

}  // namespace level0_key_test
}  // namespace pamr
