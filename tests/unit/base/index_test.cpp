// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/index.hpp"

#include <gtest/gtest.h>

#include <cstdint>
#include <limits>
#include <type_traits>

#include "pamr/base/types.hpp"

namespace pamr {
namespace index_test {

TEST(At, KeepsTheValueOfEveryWidth) {
  EXPECT_EQ(at(std::uint8_t{255}), 255U);
  EXPECT_EQ(at(std::numeric_limits<LocalId>::max()), 2147483647U);
  EXPECT_EQ(at(std::numeric_limits<GlobalId>::max()), 9223372036854775807U);
  EXPECT_EQ(at(std::size_t{7}), 7U);
}

TEST(At, IsAConstantOfTheTypeOfIndices) {
  static_assert(at(3) == 3);
  static_assert(std::is_same_v<decltype(at(LocalId{0})), std::size_t>);
}

}  // namespace index_test
}  // namespace pamr
