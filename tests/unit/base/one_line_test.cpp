// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/one_line.hpp"

#include <gtest/gtest.h>

#include <string>

namespace one_line_test {

TEST(OneLine, HasNoControlCharacters) {
  EXPECT_EQ(pamr::one_line("\x1b[2J\r\n\t\x7f"), "\\x1b[2J\\x0d\\n\\x09\\x7f");
  EXPECT_EQ(pamr::one_line("\xc2\x9b 2J"), "\\x9b 2J");  // a terminal's control sequence in one character
}

TEST(OneLine, LeavesEverythingElseAsItIs) {
  for (const std::string text : {"", "caf\xc3\xa9 \xe6\xb7\xb1", "\xc2", "\xff", "a\\nb"})
    EXPECT_EQ(pamr::one_line(text), text);
}

}  // namespace one_line_test
