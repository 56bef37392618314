// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/families.hpp"

#include <fmt/format.h>

#include <bit>

namespace pamr::mesh {

bool is_well_formed(Lineage lineage) {
  if (lineage.code() >= n_family_codes) return false;
  if (lineage.is_broken() && !(lineage.is_closure() && lineage.path() == 0)) return false;
  const auto path = lineage.path();
  const bool is_path = path == 0 || (path > 1 && path <= Lineage::max_path && std::bit_width(path) % 3 == 1);
  return is_path && lineage.depth() <= lineage.level();
}

std::string describe(Lineage lineage) {
  if (!is_well_formed(lineage)) return fmt::format("lineage word {}", lineage.bits());
  auto place = fmt::format(", level {}", lineage.level());
  if (lineage.depth() > 0) {
    place += ", child numbers";
    for (int i = lineage.depth(); i-- > 0;) place += fmt::format(" {}", lineage.path() >> (3 * i) & 7U);
  }
  if (!lineage.is_closure()) return "regular cell" + place;
  const auto kind = lineage.kind() == FamilyKind::edge   ? fmt::format("1:2 closure cell of edge {}", lineage.index())
                    : lineage.kind() == FamilyKind::face ? fmt::format("1:4 closure cell of face {}", lineage.index())
                                                         : fmt::format("closure cell of state {}", lineage.state());
  return fmt::format("{}{}, child {}{}", lineage.is_broken() ? "broken " : "", kind, lineage.child(), place);
}

}  // namespace pamr::mesh
