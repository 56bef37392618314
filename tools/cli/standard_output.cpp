// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/standard_output.hpp"

#include <cerrno>
#include <cstdio>
#include <system_error>

namespace pamr::cli {

namespace {

int first_failure = 0;  // an errno; one thread prints

}  // namespace

void print(const std::string& text) {
  errno = 0;
  const bool has_arrived = std::fputs(text.c_str(), stdout) >= 0 && std::fflush(stdout) == 0;
  if (!has_arrived && first_failure == 0) first_failure = errno == 0 ? EIO : errno;
}

std::string trouble_of_output() {
  if (first_failure == 0 || first_failure == EBADF) return {};
  return std::generic_category().message(first_failure);
}

}  // namespace pamr::cli
