// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/closure.hpp"

#include "pamr/base/index.hpp"

namespace pamr::refine {

std::vector<std::uint8_t> count_children(const Closure& closure) {
  std::vector<std::uint8_t> counts(closure.marks.size(), 0);
  for (std::size_t c = 0; c < counts.size(); ++c)
    if (closure.action[c] == Action::split)
      counts[c] = static_cast<std::uint8_t>(split_pattern[at(state_of_mask[closure.marks[c]])].n_children);
  for (const auto& family : closure.rebuilt) counts[at(family.first)] = static_cast<std::uint8_t>(family.n_children);
  return counts;
}

std::int64_t count_not_split(const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags, const Closure& closure) {
  std::int64_t n = 0;
  auto family = closure.rebuilt.begin();
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    if (flags[at(c)] == 0) continue;
    if (closure.action[at(c)] == Action::split) {
      n += closure.marks[at(c)] == all_edges ? 0 : 1;
      continue;
    }
    const auto first = c - mesh.lineage[at(c)].child();
    while (family->first < first) ++family;
    n += split_pattern[at(family->state)].mask == all_edges ? 0 : 1;
  }
  return n;
}

}  // namespace pamr::refine
