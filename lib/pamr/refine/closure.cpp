// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/closure.hpp"

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/base/prefetch.hpp"
#include "pamr/refine/policy.hpp"
#include "pamr/refine/requests.hpp"

namespace pamr::refine {

void find_states(const mesh::DistMesh& mesh, const Options& options, Closure& closure) {
  constexpr LocalId ahead = 16;
  const mesh::Level0View level0(mesh);
  assign_array(closure.state, at(mesh.n_cells()), SplitState{0});
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    if (c + ahead < mesh.n_cells() && closure.marks[at(c + ahead)] != 0 && closure.marks[at(c + ahead)] != all_edges)
      for (const auto node : mesh.cell_to_node[at(c + ahead)]) {
        prefetch(&mesh.node_position[at(node)]);
        level0.prefetch_key(node);
      }
    if (closure.action[at(c)] == Action::split)
      closure.state[at(c)] = state_of_cell(mesh, level0, c, closure.marks[at(c)], options);
  }
}

void decide_actions(const mesh::DistMesh& mesh, Closure& closure) {
  assign_array(closure.action, at(mesh.n_cells()), Action::split);
  for (const auto& family : closure.rebuilt) {
    closure.action[at(family.first)] = Action::rebuild;
    for (int child = 1; child < mesh.lineage[at(family.first)].family_size(); ++child)
      closure.action[at(family.first + child)] = Action::absorbed;
  }
}

std::vector<std::uint8_t> count_children(const Closure& closure) {
  std::vector<std::uint8_t> counts(closure.marks.size(), 0);
  for (std::size_t c = 0; c < counts.size(); ++c)
    if (closure.action[c] == Action::split)
      counts[c] = static_cast<std::uint8_t>(split_pattern[closure.state[c]].n_children);
  for (const auto& family : closure.rebuilt) counts[at(family.first)] = family.n_children;
  return counts;
}

std::int64_t count_not_split(const mesh::DistMesh& mesh, std::span<const std::uint8_t> requests,
                             const Closure& closure) {
  std::int64_t n = 0;
  auto family = closure.rebuilt.begin();
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    if (!asks_for(requests[at(c)], Request::split)) continue;
    if (closure.action[at(c)] == Action::split) {
      n += closure.marks[at(c)] == all_edges ? 0 : 1;
      continue;
    }
    const auto first = c - mesh.lineage[at(c)].child();
    while (family->first < first) ++family;
    n += is_regular_split(family->state) ? 0 : 1;
  }
  return n;
}

}  // namespace pamr::refine
