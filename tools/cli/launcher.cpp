// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/launcher.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>

namespace pamr::cli {

bool is_under_launcher() {
  const std::array names{"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"};
  return std::any_of(names.begin(), names.end(), [](const char* name) { return std::getenv(name) != nullptr; });
}

bool launcher_holds_lines_back() { return is_under_launcher() && std::getenv("PRTE_LAUNCHED") != nullptr; }

}  // namespace pamr::cli
