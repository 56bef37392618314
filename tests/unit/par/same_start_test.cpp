// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/par/same_start.hpp"

#include <gtest/gtest.h>

#include <string>

#include "pamr/base/error.hpp"

namespace pamr::par {
namespace same_start_test {

/// The error of every rank; empty for none.
std::string trouble_of(const Comm& comm, const Start& start) {
  try {
    require_same_start(comm, start);
  } catch (const Error& error) {
    EXPECT_EQ(comm.broadcast(error.what()), error.what()) << "ranks differ in what they say";
    return error.what();
  }
  return {};
}

TEST(SameStart, IsThatOfEqualWordsInOneFolder) {
  const Comm comm(MPI_COMM_WORLD);
  EXPECT_EQ(trouble_of(comm, {"1.0", "/here", {"in", "-o", "out"}}), "");
  EXPECT_EQ(trouble_of(comm, {"1.0", "", {}}), "");
}

TEST(SameStart, NamesTheFirstWordThatDiffers) {
  const Comm comm(MPI_COMM_WORLD);
  if (comm.size() == 1) return;  // no other rank to differ from
  const bool is_last = comm.rank() == comm.size() - 1;
  const auto last = std::to_string(comm.size() - 1);
  const std::string other = is_last ? "b" : "a";

  EXPECT_EQ(trouble_of(comm, {"1", "/x", {"in", "-o", other}}),
            "expected the same arguments (number 3) on all ranks, found 'a' on rank 0 and 'b' on rank " + last);
  EXPECT_EQ(trouble_of(comm, {"1", other, {"in"}}),
            "expected the same working folder on all ranks, found 'a' on rank 0 and 'b' on rank " + last);
  EXPECT_EQ(trouble_of(comm, {other, "/x", {"in"}}),
            "expected the same version of the program on all ranks, found 'a' on rank 0 and 'b' on rank " + last);
}

TEST(SameStart, TellsWordsApartThatAreTheSameLetters) {
  const Comm comm(MPI_COMM_WORLD);
  if (comm.size() == 1) return;  // no other rank to differ from
  Start start{"1", "/x", {"ab", "c"}};
  if (comm.is_first()) start.arguments = {"a", "bc"};
  EXPECT_NE(trouble_of(comm, start).find("'a' on rank 0 and 'ab' on rank 1"), std::string::npos);

  start.arguments = {"a", "--force"};
  if (comm.is_first()) start.arguments.pop_back();
  EXPECT_NE(trouble_of(comm, start).find("found none on rank 0 and '--force' on rank 1"), std::string::npos);
}

}  // namespace same_start_test
}  // namespace pamr::par
