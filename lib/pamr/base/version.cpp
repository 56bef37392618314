// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/base/version.hpp"

#define PAMR_AS_TEXT(number) #number
#define PAMR_AS_VERSION(major, minor, patch) PAMR_AS_TEXT(major) "." PAMR_AS_TEXT(minor) "." PAMR_AS_TEXT(patch)

namespace pamr {

std::string_view version() { return PAMR_AS_VERSION(PAMR_VERSION_MAJOR, PAMR_VERSION_MINOR, PAMR_VERSION_PATCH); }

}  // namespace pamr
