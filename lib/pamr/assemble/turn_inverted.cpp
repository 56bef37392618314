// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/assemble/turn_inverted.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/mesh/id_map.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::assemble {

TurnedCells turn_inverted(const par::Comm& comm, mesh::BlockMesh& block) {
  const auto all = block.info.node_ids();
  GlobalId least = std::numeric_limits<GlobalId>::max(), greatest = -1;
  par::agree(comm, [&] {
    const auto own = par::block_range(all, comm.rank(), comm.size());
    if (std::ssize(block.node_position) != own.count())
      throw Error(fmt::format("node block: expected {} entries, found {} (rank {})", own.count(),
                              block.node_position.size(), comm.rank()));
    for (std::size_t c = 0; c < block.cell_to_node.size(); ++c)
      for (const auto node : block.cell_to_node[c]) {
        if (!all.contains(node))
          throw Error(fmt::format("cell_to_node, cell {}: expected node numbers from {} to {}, found {}",
                                  block.first_cell + static_cast<GlobalId>(c), all.first, all.end() - 1, node));
        least = std::min(least, node);
        greatest = std::max(greatest, node);
      }
  });
  std::vector<GlobalId> named;
  std::vector<LocalId> corner;
  if (!block.cell_to_node.empty()) {
    mesh::IdMap local(least, greatest, block.cell_to_node.size() / 4);
    corner.reserve(4 * block.cell_to_node.size());
    for (const auto& nodes : block.cell_to_node)
      for (const auto node : nodes) {
        corner.push_back(local.find_or_insert(node, static_cast<LocalId>(named.size())));
        if (at(corner.back()) == named.size()) named.push_back(node);
      }
  }
  const auto point = par::fetch_rows<geometry::Vec3>(comm, all, block.node_position, 1, named);
  std::array<std::int64_t, 2> count{0, 0};
  for (std::size_t c = 0; c < block.cell_to_node.size(); ++c) {
    const auto p = [&](std::size_t i) { return point[at(corner[4 * c + i])]; };
    const int sign = geometry::orientation(p(0), p(1), p(2), p(3));
    count[1] += sign == 0 ? 1 : 0;
    if (sign >= 0) continue;
    ++count[0];
    std::swap(block.cell_to_node[c][2], block.cell_to_node[c][3]);
    if (!block.cell_to_cell.empty()) std::swap(block.cell_to_cell[c][2], block.cell_to_cell[c][3]);
  }
  comm.sum_in_place(count);
  return {count[0], count[1]};
}

TurnedCells orient(const par::Comm& comm, mesh::BlockMesh& block, Exact<bool> repair) {
  const auto result = turn_inverted(comm, block);
  const auto n_turned = result.n_turned;
  if (result.n_flat == 0 && n_turned > 0 && n_turned < block.info.n_global_cells && !repair)
    throw Error(
        fmt::format("expected cells of positive volume, found {} inverted ones among {} cells (they are turned over "
                    "without --strict, in Python by repair=True)",
                    n_turned, block.info.n_global_cells));
  return result;
}

}  // namespace pamr::assemble
