// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/new_level.hpp"

namespace pamr::refine {

std::vector<LocalId> cells_with_moved_nodes(const NewLevel& level, const std::vector<Movable>& movables) {
  std::vector<LocalId> cells;
  if (movables.empty()) return cells;
  std::vector<std::uint8_t> moves(level.n_nodes(), 0);
  for (const auto& m : movables) moves[at(m.node)] = 1;
  for (LocalId c = 0; c < level.n_cells(); ++c) {
    const auto& nodes = level.children.cell_to_node[at(c)];
    if ((moves[at(nodes[0])] | moves[at(nodes[1])] | moves[at(nodes[2])] | moves[at(nodes[3])]) != 0)
      cells.push_back(c);
  }
  return cells;
}

}  // namespace pamr::refine
