// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/periodic_patches.hpp"

#include <fmt/format.h>

#include "pamr/base/listed.hpp"

namespace pamr::mesh {

std::string warning_of_periodic(const std::vector<Patch>& patches) {
  std::vector<std::string> names;
  for (const auto& patch : patches)
    if (patch.kind == periodic_kind) names.push_back("'" + patch.name + "'");
  const auto n = names.size();
  if (n == 0) return {};
  return fmt::format(
      "{} {} periodic, but the links are not kept: refined faces match those of the other side only where both sides "
      "are "
      "refined alike",
      n == 1 ? "patch" : "patches", listed(names) + (n == 1 ? " is" : " are"));
}

}  // namespace pamr::mesh
