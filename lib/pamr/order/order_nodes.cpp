// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/order/order_nodes.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "pamr/mesh/first_use.hpp"
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
  const auto block = par::block_range(nodes, comm.rank(), comm.size());
  const auto groups = par::detail::group_by_block(nodes, comm.size(), named, block);
  std::vector<par::Outgoing<GlobalId>> questions;
  for (const auto& group : groups) {
    questions.push_back({group.to, {}});
    for (const auto i : group.item) questions.back().item.push_back(named[i]);
  }
  const auto asked = comm.sparse_exchange(questions);
  Claims claims;
  claims.is_named.assign(static_cast<std::size_t>(block.count()), 0);
  claims.is_first.assign(named.size(), 0);
  const auto claim_node = [&](GlobalId node) {
    return std::exchange(claims.is_named[static_cast<std::size_t>(node - block.begin)], 1) == 0 ? char{1} : char{0};
  };
  const auto claim_own = [&] {
    for (std::size_t i = 0; i < named.size(); ++i)
      if (block.contains(named[i])) claims.is_first[i] = claim_node(named[i]);
  };
  bool are_own_done = false;
  std::vector<par::Outgoing<char>> answers;
  for (std::size_t r = 0; r < asked.rank.size(); ++r) {  // ranks ascend
    if (asked.rank[r] > comm.rank() && !std::exchange(are_own_done, true)) claim_own();
    answers.push_back({asked.rank[r], {}});
    for (const auto node : asked.from(r)) answers.back().item.push_back(claim_node(node));
  }
  if (!are_own_done) claim_own();
  const auto answered = comm.sparse_exchange(answers);
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

std::vector<GlobalId> renumber_nodes(const par::Comm& comm, mesh::BlockMesh& block) {
  const auto nodes = block.info.node_ids();
  auto& cells = block.cell_to_node;  // name the places of their nodes from here on
  const auto named =
      mesh::nodes_by_first_use(cells, [&](std::size_t c, std::size_t i, LocalId place) { cells[c][i] = place; });
  const auto claims = claim(comm, nodes, named);

  // this rank's part of the numbers: nodes that no cell on a lower rank names
  std::vector<GlobalId> own;
  for (std::size_t i = 0; i < named.size(); ++i)
    if (claims.is_first[i] != 0) own.push_back(named[i]);
  std::vector<GlobalId> number(own.size());
  std::iota(number.begin(), number.end(), nodes.first + comm.exclusive_sum(static_cast<std::int64_t>(own.size())));
  auto new_of_block = par::scatter_rows<GlobalId>(comm, nodes, number, 1, own);

  const auto n_unnamed = std::count(claims.is_named.begin(), claims.is_named.end(), 0);
  auto next = nodes.first + comm.sum(static_cast<std::int64_t>(own.size())) + comm.exclusive_sum(n_unnamed);
  for (std::size_t i = 0; i < new_of_block.size(); ++i)
    if (claims.is_named[i] == 0) new_of_block[i] = next++;

  const auto new_of_named = par::fetch_rows<GlobalId>(comm, nodes, new_of_block, 1, named);
  for (auto& corners : cells)
    for (auto& node : corners) node = new_of_named[static_cast<std::size_t>(node)];

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
