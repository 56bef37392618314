// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/with_file_name.hpp"

#include <gtest/gtest.h>

#include <stdexcept>
#include <string>

namespace pamr {
namespace with_file_name_test {

TEST(WithFileName, ReturnsWhatTheWorkReturns) {
  EXPECT_EQ(with_file_name("a.hdf", [] { return 7; }), 7);
  int calls = 0;
  with_file_name("a.hdf", [&] { ++calls; });
  EXPECT_EQ(calls, 1);
}

TEST(WithFileName, NamesTheFileInAnErrorOfTheInput) {
  try {
    with_file_name("dir/a.hdf", [] { throw Error("cell 3 is inverted"); });
    FAIL();
  } catch (const Error& error) {
    EXPECT_STREQ(error.what(), "file 'dir/a.hdf': cell 3 is inverted");
  }
}

TEST(WithFileName, LeavesOtherExceptionsAsTheyAre) {
  EXPECT_THROW(with_file_name("a.hdf", [] { throw std::out_of_range("5"); }), std::out_of_range);
}

}  // namespace with_file_name_test
}  // namespace pamr
