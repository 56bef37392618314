// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/sum_modulo.hpp"

#include <gtest/gtest.h>

namespace pamr::par {
namespace sum_modulo_test {

TEST(SumModulo, WrapsAroundLikeASumOnOneRank) {
  const Comm comm(MPI_COMM_WORLD);
  const auto term = [](Rank rank) {
    return 0xfedcba9876543210U + 0x0123456789abcdefU * static_cast<std::uint64_t>(rank);
  };
  std::uint64_t expected = 0;
  for (Rank rank = 0; rank < comm.size(); ++rank) expected += term(rank);
  EXPECT_EQ(sum_modulo(comm, term(comm.rank())), expected);
}

}  // namespace sum_modulo_test
}  // namespace pamr::par
