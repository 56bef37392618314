// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/order/order_over_ranks.hpp"

#include <algorithm>
#include <numeric>
#include <utility>
#include <variant>

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/base/prefetch.hpp"
#include "pamr/mesh/families.hpp"
#include "pamr/mesh/id_map.hpp"
#include "pamr/order/order_nodes.hpp"
#include "pamr/order/route.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::order {

namespace {

/// Cells whose neighbors are asked for at once.
constexpr std::size_t cells_of_round = std::size_t{1} << 17U;

/// Gives all cells of a tree the key of its first one, whatever rank that is on. Collective: four gathers of a number a
/// rank.
void share_tree_keys(const par::Comm& comm, const mesh::BlockMesh& block, std::vector<std::uint64_t>& key) {
  const auto& lineage = block.lineage;
  std::size_t n_leading = lineage.empty() ? 0 : 1;  // cells that may follow one of an earlier rank
  for (; n_leading < lineage.size(); ++n_leading)
    if (!mesh::follows_in_tree(lineage[n_leading - 1], lineage[n_leading])) break;
  for (std::size_t c = 1; c < key.size(); ++c)
    if (mesh::follows_in_tree(lineage[c - 1], lineage[c])) key[c] = key[c - 1];
  // of each rank its first and last cell, the last one's key so far, and whether one tree holds all of its cells
  const auto first =
      comm.all_gather(lineage.empty() ? std::int64_t{-1} : static_cast<std::int64_t>(lineage.front().bits()));
  const auto last =
      comm.all_gather(lineage.empty() ? std::int64_t{-1} : static_cast<std::int64_t>(lineage.back().bits()));
  const auto last_key = comm.all_gather(key.empty() ? std::int64_t{0} : static_cast<std::int64_t>(key.back()));
  const auto is_one = comm.all_gather(std::int64_t{n_leading == lineage.size() ? 1 : 0});
  Rank before = -1;
  std::int64_t key_before = 0;
  for (Rank r = 0; r <= comm.rank(); ++r) {
    const auto i = static_cast<std::size_t>(r);
    if (first[i] < 0) continue;
    const bool follows =
        before >= 0 &&
        mesh::follows_in_tree(mesh::Lineage(static_cast<std::uint64_t>(last[static_cast<std::size_t>(before)])),
                              mesh::Lineage(static_cast<std::uint64_t>(first[i])));
    if (r == comm.rank() && follows) std::fill_n(key.begin(), n_leading, static_cast<std::uint64_t>(key_before));
    if (!follows || is_one[i] == 0) key_before = last_key[i];
    before = r;
  }
}

/// Where the corners of this rank's cells lie. Only the nodes of other ranks' blocks are asked for, each once.
class CornerPoints {
 public:
  /// Collective.
  CornerPoints(const par::Comm& comm, const mesh::BlockMesh& block)
      : own_point_(block.node_position),
        own_(par::block_range(block.info.node_ids(), comm.rank(), comm.size())),
        other_(block.info.node_ids().first, block.info.node_ids().end() - 1,
               std::min(block.cell_to_node.size(), own_point_.size())) {
    std::vector<GlobalId> asked;
    for (const auto& nodes : block.cell_to_node)
      for (const auto node : nodes) {
        if (own_.contains(node)) continue;
        const auto next = static_cast<LocalId>(asked.size());
        if (other_.find_or_insert(node, next) == next) asked.push_back(node);
      }
    other_point_ = par::fetch_rows<geometry::Vec3>(comm, block.info.node_ids(), own_point_, 1, asked);
  }

  const geometry::Vec3& operator()(GlobalId node) const {
    return own_.contains(node) ? own_point_[static_cast<std::size_t>(node - own_.begin)]
                               : other_point_[static_cast<std::size_t>(other_.find(node))];
  }
  void prefetch_point(GlobalId node) const {
    if (own_.contains(node)) prefetch(&(*this)(node));
  }

 private:
  const std::vector<geometry::Vec3>& own_point_;
  par::BlockRange own_;
  mesh::IdMap other_;  ///< places of the other nodes in `other_point_`
  std::vector<geometry::Vec3> other_point_;
};

/// Collective.
std::vector<std::uint64_t> find_keys(const par::Comm& comm, const mesh::BlockMesh& block, const CurveGrid& grid,
                                     bool has_lineage) {
  constexpr std::size_t cells_ahead = 24;
  const CornerPoints point(comm, block);
  const auto& cells = block.cell_to_node;
  std::vector<std::uint64_t> key;
  reserve_array(key, cells.size());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (c + cells_ahead < cells.size())
      for (const auto node : cells[c + cells_ahead]) point.prefetch_point(node);
    const auto& n = cells[c];
    key.push_back(key_of(grid, {point(n[0]), point(n[1]), point(n[2]), point(n[3])}));
  }
  if (has_lineage) share_tree_keys(comm, block, key);
  return key;
}

/// The numbers that this rank's cells have.
std::vector<GlobalId> numbers_of(const mesh::BlockMesh& block) {
  std::vector<GlobalId> numbers;
  assign_array(numbers, block.cell_to_node.size(), GlobalId{0});
  std::iota(numbers.begin(), numbers.end(), block.first_cell);
  return numbers;
}

/// Replaces the old numbers of neighbors by the new ones. `old_number`, `new_number`: of this rank's cells. Collective.
void renumber_neighbors(const par::Comm& comm, mesh::BlockMesh& block, const std::vector<GlobalId>& old_number,
                        const std::vector<GlobalId>& new_number) {
  const auto cells = block.info.cell_ids();
  const auto new_of_block = par::scatter_rows<GlobalId>(comm, cells, new_number, 1, old_number);
  const auto here = par::block_range(cells, comm.rank(), comm.size());
  par::in_rounds(comm, block.cell_to_cell.size(), cells_of_round, [&](std::size_t begin, std::size_t end) {
    std::vector<GlobalId> asked;
    for (auto c = begin; c < end; ++c)
      for (const auto neighbor : block.cell_to_cell[c])
        if (neighbor >= 0 && !here.contains(neighbor)) asked.push_back(neighbor);
    const auto answered = par::fetch_rows<GlobalId>(comm, cells, new_of_block, 1, asked);
    auto next = answered.begin();
    for (auto c = begin; c < end; ++c)
      for (auto& neighbor : block.cell_to_cell[c])
        if (neighbor >= 0)
          neighbor = here.contains(neighbor) ? new_of_block[static_cast<std::size_t>(neighbor - here.begin)] : *next++;
  });
}

/// Sends the cells, and what they were numbered, to the canonical blocks of their new numbers. Collective.
void move_cells(const par::Comm& comm, mesh::BlockMesh& block, std::vector<GlobalId>& numbers, const Route& route,
                const assemble::Contents& contents) {
  const auto send = [&](auto& rows, std::size_t width) { send_rows(comm, route, rows, width); };
  send(numbers, 1);
  send(block.cell_to_node, 1);
  if (contents.has_neighbors) send(block.cell_to_cell, 1);
  if (contents.has_lineage) send(block.lineage, 1);
  if (contents.has_origin) send(block.cell_origin, 1);
  for (auto& field : block.cell_fields)
    std::visit([&](auto& values) { send(values, at(field.n_components)); }, field.value);
  block.first_cell = par::block_range(block.info.cell_ids(), comm.rank(), comm.size()).begin;
}

}  // namespace

Ordered order_over_ranks(const par::Comm& comm, mesh::BlockMesh block, const CurveGrid& grid,
                         const assemble::Contents& contents) {
  const auto route = find_route(comm, block, find_keys(comm, block, grid, contents.has_lineage));
  auto numbers = numbers_of(block);
  if (contents.has_neighbors) renumber_neighbors(comm, block, numbers, new_numbers(comm, route, block.info.cell_ids()));
  move_cells(comm, block, numbers, route, contents);

  Ordered ordered;
  ordered.cell_origin = std::move(numbers);
  ordered.node_origin = renumber_nodes(comm, block);
  ordered.block = std::move(block);
  return ordered;
}

}  // namespace pamr::order
