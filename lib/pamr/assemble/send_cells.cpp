// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/assemble/send_cells.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/base/sorted_order.hpp"

namespace pamr::assemble {

namespace {

constexpr std::size_t cells_of_round = std::size_t{1} << 17U;

/// A cell on its way, without its fields.
struct Traveller {
  GlobalId id = 0;
  std::array<GlobalId, 4> node{};
  std::array<GlobalId, 4> neighbor{};
  std::uint64_t lineage = 0;
};

std::vector<std::size_t> find_departing(const std::vector<Rank>& to, Rank here) {
  std::vector<std::size_t> departing;
  reserve_array(departing, to.size());
  for (std::size_t i = 0; i < to.size(); ++i)
    if (to[i] != here) departing.push_back(i);
  return departing;
}

/// The cells of one round, grouped by target.
std::vector<par::Outgoing<std::size_t>> group_by_target(std::span<const std::size_t> cells,
                                                        const std::vector<Rank>& to) {
  std::vector<std::size_t> order(cells.begin(), cells.end());
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return to[a] < to[b]; });
  std::vector<par::Outgoing<std::size_t>> groups;
  for (const auto cell : order) {
    if (groups.empty() || groups.back().to != to[cell]) groups.push_back({to[cell], {}});
    groups.back().item.push_back(cell);
  }
  return groups;
}

template <class T, class Make>
par::Received<T> send_groups(const par::Comm& comm, const std::vector<par::Outgoing<std::size_t>>& groups,
                             std::size_t width, Make append) {
  std::vector<par::Outgoing<T>> messages;
  for (const auto& group : groups) {
    messages.push_back({group.to, {}});
    messages.back().item.reserve(group.item.size() * width);
    for (const auto cell : group.item) append(cell, messages.back().item);
  }
  return comm.sparse_exchange(messages);
}

void send_round(const par::Comm& comm, const GlobalCells& from, std::span<const std::size_t> cells,
                const std::vector<Rank>& to, const Contents& contents, GlobalCells& arrived) {
  const bool has_neighbors = contents.has_neighbors;
  const auto groups = group_by_target(cells, to);
  const auto travellers = send_groups<Traveller>(comm, groups, 1, [&](std::size_t cell, std::vector<Traveller>& out) {
    out.push_back({from.id[cell], from.node[cell], has_neighbors ? from.neighbor[cell] : std::array<GlobalId, 4>{},
                   from.lineage[cell].bits()});
  });
  for (const auto& cell : travellers.item) {
    arrived.id.push_back(cell.id);
    arrived.node.push_back(cell.node);
    if (has_neighbors) arrived.neighbor.push_back(cell.neighbor);
    arrived.lineage.push_back(mesh::Lineage(cell.lineage));
  }
  if (contents.has_origin) {
    const auto rows = send_groups<GlobalId>(
        comm, groups, 1, [&](std::size_t cell, std::vector<GlobalId>& out) { out.push_back(from.origin[cell]); });
    arrived.origin.insert(arrived.origin.end(), rows.item.begin(), rows.item.end());
  }
  for (std::size_t f = 0; f < from.field.size(); ++f)
    std::visit(
        [&]<class T>(const std::vector<T>& values) {
          const auto width = static_cast<std::size_t>(from.field[f].n_components);
          const auto rows = send_groups<T>(comm, groups, width, [&](std::size_t cell, std::vector<T>& out) {
            const auto row = values.begin() + static_cast<std::ptrdiff_t>(cell * width);
            out.insert(out.end(), row, row + static_cast<std::ptrdiff_t>(width));
          });
          auto& all = std::get<std::vector<T>>(arrived.field[f].value);
          all.insert(all.end(), rows.item.begin(), rows.item.end());
        },
        from.field[f].value);
}

/// Replaces `rows` by the rows that `order` names: numbers beyond the last of `rows` mean rows of `more`, which is freed.
template <class T>
void select_rows(std::vector<T>& rows, std::vector<T>& more, std::size_t width, std::span<const std::size_t> order) {
  std::vector<T> selected;
  reserve_array(selected, order.size() * width);
  const auto n = rows.size() / width;
  for (const auto i : order) {
    const auto* row = i < n ? &rows[i * width] : &more[(i - n) * width];
    for (std::size_t k = 0; k < width; ++k) selected.push_back(row[k]);
  }
  rows = std::move(selected);
  free_array(more);
}

/// Rows of the cells that stay, then of those that arrived (as if they stood behind all the old ones), by number.
std::vector<std::size_t> order_by_number(const std::vector<GlobalId>& old_id, const std::vector<GlobalId>& arrived_id,
                                         const std::vector<Rank>& to, Rank here) {
  std::vector<std::size_t> row;
  std::vector<std::uint64_t> id;
  reserve_array(row, old_id.size() + arrived_id.size());
  for (std::size_t i = 0; i < old_id.size(); ++i)
    if (to[i] == here) row.push_back(i);
  for (std::size_t i = 0; i < arrived_id.size(); ++i) row.push_back(old_id.size() + i);
  reserve_array(id, row.size());
  for (const auto i : row)
    id.push_back(static_cast<std::uint64_t>(i < old_id.size() ? old_id[i] : arrived_id[i - old_id.size()]));
  const auto least = id.empty() ? 0 : *std::min_element(id.begin(), id.end());
  for (auto& number : id) number -= least;
  std::vector<std::size_t> result;
  reserve_array(result, row.size());
  for (const auto i : sorted_order(id)) result.push_back(row[i]);
  return result;
}

/// Drops the departed cells, adds the arrived ones and puts all in ascending order.
void merge(GlobalCells& cells, GlobalCells arrived, const std::vector<Rank>& to, Rank here, const Contents& contents) {
  const auto order = order_by_number(cells.id, arrived.id, to, here);
  const auto select = [&](auto& mine, auto& theirs, std::size_t width) { select_rows(mine, theirs, width, order); };
  select(cells.id, arrived.id, 1);
  select(cells.node, arrived.node, 1);
  if (contents.has_neighbors) select(cells.neighbor, arrived.neighbor, 1);
  select(cells.lineage, arrived.lineage, 1);
  if (contents.has_origin) select(cells.origin, arrived.origin, 1);
  for (std::size_t f = 0; f < cells.field.size(); ++f)
    std::visit(
        [&]<class T>(std::vector<T>& values) {
          select(values, std::get<std::vector<T>>(arrived.field[f].value), at(cells.field[f].n_components));
        },
        cells.field[f].value);
}

/// The cells of the block, taken out of it, with their numbers; lineage is made where there is none.
GlobalCells take_cells(mesh::BlockMesh& block, const Contents& contents) {
  GlobalCells cells;
  const auto n = block.cell_to_node.size();
  cells.node = std::exchange(block.cell_to_node, {});
  cells.neighbor = std::exchange(block.cell_to_cell, {});
  cells.lineage = std::exchange(block.lineage, {});
  cells.origin = std::exchange(block.cell_origin, {});
  if (!contents.has_lineage) cells.lineage.resize(n);
  cells.field = std::exchange(block.cell_fields, {});
  reserve_array(cells.id, n);
  cells.id.resize(n);
  std::iota(cells.id.begin(), cells.id.end(), block.first_cell);
  return cells;
}

/// Sends the cells to the ranks `to`; what is then here ascends. Collective.
void exchange_cells(const par::Comm& comm, GlobalCells& cells, const std::vector<Rank>& to, const Contents& contents) {
  const auto departing = find_departing(to, comm.rank());
  const auto rounds = static_cast<std::size_t>(
      comm.max(static_cast<std::int64_t>((departing.size() + cells_of_round - 1) / cells_of_round)));
  if (rounds == 0) return;

  GlobalCells arrived;
  for (const auto& field : cells.field) {
    auto& empty =
        arrived.field.emplace_back(mesh::CellField{field.name, field.unit, field.n_components, field.storage, {}});
    if (field.holds_integers()) empty.value = std::vector<std::int64_t>{};
  }
  for (std::size_t round = 0; round < rounds; ++round) {
    const auto begin = std::min(round * cells_of_round, departing.size());
    const auto end = std::min(begin + cells_of_round, departing.size());
    send_round(comm, cells, std::span<const std::size_t>(departing).subspan(begin, end - begin), to, contents, arrived);
  }
  merge(cells, std::move(arrived), to, comm.rank(), contents);
}

}  // namespace

GlobalCells send_cells(const par::Comm& comm, mesh::BlockMesh& block, const std::vector<Rank>& to,
                       const Contents& contents) {
  auto cells = take_cells(block, contents);
  exchange_cells(comm, cells, to, contents);
  return cells;
}

}  // namespace pamr::assemble
