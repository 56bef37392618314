// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/version.hpp"

#include <gtest/gtest.h>

#include <string>

namespace pamr {

TEST(Version, OfTheLibraryIsThatOfItsHeaders) {
  EXPECT_EQ(version(), std::to_string(PAMR_VERSION_MAJOR) + "." + std::to_string(PAMR_VERSION_MINOR) + "." +
                           std::to_string(PAMR_VERSION_PATCH));
}

}  // namespace pamr
