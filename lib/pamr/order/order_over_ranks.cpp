// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/order/order_over_ranks.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "pamr/assemble/check_block.hpp"
#include "pamr/assemble/send_cells.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/base/prefetch.hpp"
#include "pamr/mesh/families.hpp"
#include "pamr/order/order_nodes.hpp"
#include "pamr/order/order_places.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::order {

namespace {

/// Cells whose neighbors are asked for at once.
constexpr std::size_t cells_of_round = std::size_t{1} << 17U;

/// Corners whose points are asked for beforehand.
constexpr std::size_t corners_ahead = 64;

/// Calls `work(begin, end)` for pieces of this rank's cells, as often on every rank. Collective.
template <class Work>
void in_rounds(const par::Comm& comm, std::size_t n, Work&& work) {
  const auto rounds = comm.max(static_cast<std::int64_t>((n + cells_of_round - 1) / cells_of_round));
  for (std::int64_t round = 0; round < rounds; ++round) {
    const auto begin = std::min(n, static_cast<std::size_t>(round) * cells_of_round);
    work(begin, std::min(n, begin + cells_of_round));
  }
}

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

/// Collective.
std::vector<std::uint64_t> find_keys(const par::Comm& comm, const mesh::BlockMesh& block, const CurveGrid& grid,
                                     bool has_lineage) {
  const auto named = find_named(block.cell_to_node);
  const auto point = par::fetch_rows<geometry::Vec3>(comm, block.info.node_ids(), block.node_position, 1, named.node);
  std::vector<std::uint64_t> key;
  reserve_array(key, block.cell_to_node.size());
  const auto at = [&](std::size_t corner) -> const geometry::Vec3& {
    return point[static_cast<std::size_t>(named.corner[corner])];
  };
  for (std::size_t i = 0; i < named.corner.size(); i += 4) {
    for (auto ahead = i + corners_ahead; ahead < std::min(i + corners_ahead + 4, named.corner.size()); ++ahead)
      prefetch(&at(ahead));
    key.push_back(key_of(grid, {at(i), at(i + 1), at(i + 2), at(i + 3)}));
  }
  if (has_lineage) share_tree_keys(comm, block, key);
  return key;
}

/// Replaces the old numbers of neighbors by the new ones. `id` and `place`: old and new numbers of the block's cells.
/// Collective.
void renumber_neighbors(const par::Comm& comm, mesh::BlockMesh& block, const std::vector<GlobalId>& id,
                        const std::vector<GlobalId>& place) {
  const auto cells = block.info.cell_ids();
  const auto new_of_block = par::scatter_rows<GlobalId>(comm, cells, place, 1, id);
  const auto here = par::block_range(cells, comm.rank(), comm.size());
  const auto is_here = [&](GlobalId cell) { return cell >= here.begin && cell < here.end; };
  in_rounds(comm, block.cell_to_cell.size(), [&](std::size_t begin, std::size_t end) {
    std::vector<GlobalId> asked;
    for (auto c = begin; c < end; ++c)
      for (const auto neighbor : block.cell_to_cell[c])
        if (neighbor >= 0 && !is_here(neighbor)) asked.push_back(neighbor);
    const auto answered = par::fetch_rows<GlobalId>(comm, cells, new_of_block, 1, asked);
    auto next = answered.begin();
    for (auto c = begin; c < end; ++c)
      for (auto& neighbor : block.cell_to_cell[c])
        if (neighbor >= 0)
          neighbor = is_here(neighbor) ? new_of_block[static_cast<std::size_t>(neighbor - here.begin)] : *next++;
  });
}

/// Sends the cells to the canonical blocks of their new numbers. Returns their old ones. Collective.
std::vector<GlobalId> move_cells(const par::Comm& comm, mesh::BlockMesh& block, std::vector<GlobalId> place,
                                 std::vector<GlobalId> id, const assemble::Contents& contents) {
  std::vector<Rank> to;
  reserve_array(to, place.size());
  for (const auto number : place) to.push_back(par::block_of(number, block.info.cell_ids(), comm.size()));
  auto cells = assemble::take_cells(block, contents);
  cells.id = std::move(place);
  cells.field.push_back({"", "", 1, mesh::StorageType::int64, std::move(id)});
  assemble::exchange_cells(comm, cells, to, contents);

  block.first_cell = par::block_range(block.info.cell_ids(), comm.rank(), comm.size()).begin;
  block.cell_to_node = std::move(cells.node);
  block.cell_to_cell = std::move(cells.neighbor);
  block.lineage = std::move(cells.lineage);
  if (!contents.has_lineage) block.lineage.clear();
  auto origin = std::move(cells.field.back().integer());
  cells.field.pop_back();
  block.cell_fields = std::move(cells.field);
  return origin;
}

}  // namespace

Ordered order_over_ranks(const par::Comm& comm, mesh::BlockMesh block, const CurveGrid& grid) {
  const assemble::Contents contents{.has_neighbors = comm.any(!block.cell_to_cell.empty()),
                                    .has_lineage = comm.any(!block.lineage.empty()),
                                    .has_destinations = true};
  const auto key = find_keys(comm, block, grid, contents.has_lineage);
  auto place = places_along_curve(comm, block, key);
  std::vector<GlobalId> id(block.cell_to_node.size());
  std::iota(id.begin(), id.end(), block.first_cell);
  if (contents.has_neighbors) renumber_neighbors(comm, block, id, place);

  Ordered ordered;
  ordered.cell_origin = move_cells(comm, block, std::move(place), std::move(id), contents);
  ordered.node_origin = renumber_nodes(comm, block);
  ordered.block = std::move(block);
  return ordered;
}

}  // namespace pamr::order
