// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/order/order_nodes.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "pamr/base/memory.hpp"
#include "pamr/mesh/id_map.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::order {

namespace {

/// What the ranks of the nodes' blocks tell those whose cells name them.
struct Claims {
  std::vector<char> is_first;  ///< for each named node: no lower rank names it, so that this one numbers it
  std::vector<char> is_named;  ///< for each node of this rank's block
};

/// Collective: two sparse exchanges.
Claims claim(const par::Comm& comm, IdRange nodes, const std::vector<GlobalId>& named) {
  const auto groups = par::detail::group_by_block(nodes, comm.size(), named);
  std::vector<par::Outgoing<GlobalId>> questions;
  for (const auto& group : groups) {
    questions.push_back({group.to, {}});
    for (const auto i : group.item) questions.back().item.push_back(named[i]);
  }
  const auto asked = comm.sparse_exchange(questions);
  const auto block = par::block_range(nodes, comm.rank(), comm.size());
  Claims claims;
  claims.is_named.assign(static_cast<std::size_t>(block.count()), 0);
  std::vector<par::Outgoing<char>> answers;
  for (std::size_t r = 0; r < asked.rank.size(); ++r) {  // ranks ascend
    answers.push_back({asked.rank[r], {}});
    for (const auto node : asked.from(r)) {
      auto& is_named = claims.is_named[static_cast<std::size_t>(node - block.begin)];
      answers.back().item.push_back(is_named == 0 ? 1 : 0);
      is_named = 1;
    }
  }
  const auto answered = comm.sparse_exchange(answers);
  claims.is_first.resize(named.size());
  auto answer = answered.item.begin();  // every block that was asked answers, ranks ascending on both sides
  for (const auto& group : groups)
    for (const auto i : group.item) claims.is_first[i] = *answer++;
  return claims;
}

template <class T>
void move_rows(const par::Comm& comm, IdRange nodes, std::vector<T>& rows, std::size_t width,
               const std::vector<GlobalId>& new_of_block) {
  rows = par::scatter_rows<T>(comm, nodes, rows, width, new_of_block);
}

}  // namespace

Named find_named(const std::vector<std::array<GlobalId, 4>>& cell_to_node) {
  Named named;
  if (cell_to_node.empty()) return named;
  GlobalId least = cell_to_node[0][0], greatest = least;
  for (const auto& nodes : cell_to_node)
    for (const auto node : nodes) {
      least = std::min(least, node);
      greatest = std::max(greatest, node);
    }
  mesh::IdMap local(least, greatest, cell_to_node.size() / 4);
  reserve_array(named.corner, 4 * cell_to_node.size());
  for (const auto& nodes : cell_to_node)
    for (const auto node : nodes) {
      const auto next = static_cast<LocalId>(named.node.size());
      named.corner.push_back(local.find_or_insert(node, next));
      if (named.corner.back() == next) named.node.push_back(node);
    }
  return named;
}

std::vector<GlobalId> renumber_nodes(const par::Comm& comm, mesh::BlockMesh& block) {
  const auto nodes = block.info.node_ids();
  const auto named = find_named(block.cell_to_node);
  const auto claims = claim(comm, nodes, named.node);

  // this rank's part of the numbers: nodes that no cell on a lower rank names
  std::vector<GlobalId> own;
  for (std::size_t i = 0; i < named.node.size(); ++i)
    if (claims.is_first[i] != 0) own.push_back(named.node[i]);
  std::vector<GlobalId> number(own.size());
  std::iota(number.begin(), number.end(), nodes.first + comm.exclusive_sum(static_cast<std::int64_t>(own.size())));
  auto new_of_block = par::scatter_rows<GlobalId>(comm, nodes, number, 1, own);

  const auto n_unnamed = std::count(claims.is_named.begin(), claims.is_named.end(), 0);
  auto next = nodes.first + comm.sum(static_cast<std::int64_t>(own.size())) + comm.exclusive_sum(n_unnamed);
  for (std::size_t i = 0; i < new_of_block.size(); ++i)
    if (claims.is_named[i] == 0) new_of_block[i] = next++;

  const auto new_of_named = par::fetch_rows<GlobalId>(comm, nodes, new_of_block, 1, named.node);
  auto corner = named.corner.begin();
  for (auto& corners : block.cell_to_node)
    for (auto& node : corners) node = new_of_named[static_cast<std::size_t>(*corner++)];

  std::vector<GlobalId> of_triangles;
  for (const auto& corners : block.boundary.node)
    of_triangles.insert(of_triangles.end(), corners.begin(), corners.end());
  const auto new_of_triangles = par::fetch_rows<GlobalId>(comm, nodes, new_of_block, 1, of_triangles);
  auto next_corner = new_of_triangles.begin();
  for (auto& corners : block.boundary.node)
    for (auto& node : corners) node = *next_corner++;

  move_rows(comm, nodes, block.node_position, 1, new_of_block);
  for (auto& field : block.node_fields)
    std::visit(
        [&](auto& rows) { move_rows(comm, nodes, rows, static_cast<std::size_t>(field.n_components), new_of_block); },
        field.value);
  std::vector<GlobalId> origin(new_of_block.size());
  std::iota(origin.begin(), origin.end(), par::block_range(nodes, comm.rank(), comm.size()).begin);
  move_rows(comm, nodes, origin, 1, new_of_block);
  return origin;
}

}  // namespace pamr::order
