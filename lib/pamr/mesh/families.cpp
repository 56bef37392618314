// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/families.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace pamr::mesh {

bool is_well_formed(Lineage lineage) {
  if (lineage.code() >= n_family_codes) return false;
  if (lineage.is_broken() && !(lineage.is_closure() && lineage.path() == 0)) return false;
  const auto path = lineage.path();
  const bool is_path = path == 0 || (path > 1 && path <= Lineage::max_path && std::bit_width(path) % 3 == 1);
  return is_path && lineage.depth() <= lineage.level();
}

bool follows_in_tree(Lineage before, Lineage cell) {
  if (cell.is_removable() && cell.child() > 0) return true;
  const auto a = before.base(), b = cell.base();
  if (a.depth() == 0 || b.depth() == 0) return false;
  const auto number_at = [](Lineage l, int level) {
    return static_cast<int>(l.path() >> (3 * (l.level() - level)) & 7U);
  };
  const int root_a = a.level() - a.depth(), root_b = b.level() - b.depth();
  const bool are_complete = a.depth() < max_known_depth && b.depth() < max_known_depth;
  if (are_complete && root_a != root_b) return false;
  int level = a.level();  // of the sibling that comes next
  while (level > root_a && number_at(a, level) == 7) --level;
  if (level == root_a || level <= root_b || level > b.level()) return false;
  if (number_at(b, level) != number_at(a, level) + 1) return false;
  for (int l = level + 1; l <= b.level(); ++l)
    if (number_at(b, l) != 0) return false;
  for (int l = std::max(root_a, root_b) + 1; l < level; ++l)
    if (number_at(a, l) != number_at(b, l)) return false;
  return true;
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
