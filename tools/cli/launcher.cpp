// SPDX-License-Identifier: GPL-3.0-or-later
#include "cli/launcher.hpp"

#include <unistd.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstdlib>
#include <fstream>
#include <optional>
#include <string>

namespace pamr::cli {

bool is_under_launcher() {
  const std::array names{"OMPI_COMM_WORLD_RANK", "PMIX_RANK", "PMI_RANK"};
  return std::any_of(names.begin(), names.end(), [](const char* name) { return std::getenv(name) != nullptr; });
}

bool launcher_holds_lines_back() { return is_under_launcher() && std::getenv("PRTE_LAUNCHED") != nullptr; }

std::optional<std::uint64_t> bytes_read_by_parent() {
  std::ifstream counts("/proc/" + std::to_string(::getppid()) + "/io");
  std::string name;
  std::uint64_t n_bytes = 0;
  if (!(counts >> name >> n_bytes) || name != "rchar:") return std::nullopt;
  return n_bytes;
}

}  // namespace pamr::cli
