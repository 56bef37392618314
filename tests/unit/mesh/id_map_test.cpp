// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/id_map.hpp"

#include <gtest/gtest.h>

#include <map>
#include <random>

namespace pamr::mesh {
namespace id_map_test {

TEST(IdMap, AgreesWithAMapForNumbersCloseTogetherAndFarApart) {
  for (const GlobalId spread : {GlobalId{200}, GlobalId{1} << 20U, GlobalId{1} << 60U}) {
    std::mt19937_64 engine(7);
    const GlobalId min = 1000;
    IdMap found(min, min + spread, 100);  // more are stored than expected
    std::map<GlobalId, LocalId> expected;
    for (LocalId i = 0; i < 5000; ++i) {
      const auto id = min + static_cast<GlobalId>(engine() % static_cast<std::uint64_t>(spread + 1));
      const auto next = static_cast<LocalId>(expected.size());

      const auto local = expected.try_emplace(id, next).first->second;

      ASSERT_EQ(found.find_or_insert(id, next), local);
    }
    for (const auto& [id, local] : expected) {
      EXPECT_EQ(found.find(id), local);
      EXPECT_EQ(found.find(id + 1), expected.contains(id + 1) ? expected.at(id + 1) : invalid_local);
    }
  }
}

TEST(IdMap, DoesNotHoldNumbersOutsideItsRange) {
  IdMap map(5, 8, 4);
  map.find_or_insert(5, 0);

  EXPECT_EQ(map.find(4), invalid_local);
  EXPECT_EQ(map.find(9), invalid_local);
  EXPECT_EQ(map.find(-1), invalid_local);
  EXPECT_EQ(map.find(6), invalid_local);
}

}  // namespace id_map_test
}  // namespace pamr::mesh
