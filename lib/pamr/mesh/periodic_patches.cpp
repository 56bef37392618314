// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/periodic_patches.hpp"

#include <fmt/format.h>

namespace pamr::mesh {

std::string warning_of_periodic(const std::vector<Patch>& patches) {
  std::string names;
  int n = 0;
  for (const auto& patch : patches)
    if (patch.kind == periodic_kind) {
      names += fmt::format("{}'{}'", names.empty() ? "" : ", ", patch.name);
      ++n;
    }
  if (n == 0) return {};
  return fmt::format(
      "{} {} periodic, but the links are not kept: refined faces match those of the other side only where both sides "
      "are "
      "refined alike",
      n == 1 ? "patch" : "patches", names + (n == 1 ? " is" : " are"));
}

}  // namespace pamr::mesh
