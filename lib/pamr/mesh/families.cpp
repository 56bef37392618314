// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/families.hpp"

#include <fmt/format.h>

namespace pamr::mesh {

bool is_well_formed(Lineage lineage) {
  if ((lineage.bits() & ~0xffffU) != 0) return false;
  switch (lineage.kind()) {
    case FamilyKind::regular:
      return lineage.index() == 0 && lineage.child() == 0;
    case FamilyKind::edge:
      return lineage.index() < tet::n_edges && lineage.child() < 2;
    case FamilyKind::face:
      return lineage.index() < 4;
  }
  return false;
}

std::string describe(Lineage lineage) {
  if (!is_well_formed(lineage)) return fmt::format("lineage word {}", lineage.bits());
  const auto level = fmt::format(", level {}", lineage.level());
  if (!lineage.is_closure()) return "regular cell" + level;
  return fmt::format("{}{}{}, child {}{}", lineage.is_broken() ? "broken " : "",
                     lineage.kind() == FamilyKind::edge ? "1:2 closure cell of edge " : "1:4 closure cell of face ",
                     lineage.index(), lineage.child(), level);
}

}  // namespace pamr::mesh
