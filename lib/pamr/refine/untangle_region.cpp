// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/untangle_region.hpp"

#include <algorithm>
#include <map>

#include "pamr/base/index.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/split_pattern.hpp"

namespace pamr::refine {

namespace {

/// Nodes that may move within `n_layers` cells of the given cells.
std::vector<std::uint8_t> reach(const par::Comm& comm, const NewLevel& level, const std::vector<LocalId>& cells,
                                int n_layers) {
  const par::Exchange exchange(comm, level.shared);
  std::vector<std::uint8_t> reached(level.n_nodes(), 0);
  for (const auto c : cells)
    for (const auto node : level.children.cell_to_node[at(c)]) reached[at(node)] = 1;
  for (int layer = 0; layer < n_layers; ++layer) {
    par::fold_flags(exchange, reached);
    if (layer + 1 == n_layers) break;
    auto next = reached;
    for (const auto& nodes : level.children.cell_to_node)
      if (std::any_of(nodes.begin(), nodes.end(), [&](LocalId n) { return reached[at(n)] != 0; }))
        for (const auto n : nodes) next[at(n)] = 1;
    reached = std::move(next);
  }
  return reached;
}

/// The rows in which each of `n` nodes occurs; negative entries are none.
template <class Row>
RowsOfNode rows_of_nodes(const std::vector<Row>& rows, std::size_t n) {
  RowsOfNode result;
  result.begin.assign(n + 1, 0);
  for (const auto& row : rows)
    for (const auto i : row)
      if (i >= 0) ++result.begin[at(i) + 1];
  for (std::size_t i = 0; i < n; ++i) result.begin[i + 1] += result.begin[i];
  result.item.resize(result.begin.back());
  auto next = result.begin;
  for (std::size_t r = 0; r < rows.size(); ++r)
    for (const auto i : rows[r])
      if (i >= 0) result.item[next[at(i)]++] = static_cast<LocalId>(r);
  return result;
}

}  // namespace

Freedom free_nodes(const NewLevel& level, const Movement& movement) {
  const auto n_old_nodes = level.numbering.n_old_nodes;
  Freedom freedom;
  freedom.of_node.assign(level.n_nodes(), Freedom::inner);
  std::fill_n(freedom.of_node.begin(), n_old_nodes, Freedom::fixed);
  std::map<PatchList, std::int32_t> rows;
  const auto row_of = [&](const PatchList& patch) {
    const auto known = rows.find(patch);
    if (known != rows.end()) return known->second;
    std::int32_t row = Freedom::fixed;
    auto on = surfaces_of_node(level.info, level.surfaces, patch);
    if (on.without_surface < 0 && !on.is_on_seam) {
      row = static_cast<std::int32_t>(freedom.on.size());
      freedom.on.push_back(std::move(on));
    }
    rows.emplace(patch, row);
    return row;
  };
  for (const auto& boundary : level.numbering.boundary)
    freedom.of_node[at(n_old_nodes + boundary.new_node)] = row_of(patches_of(boundary));
  for (const auto& m : movement.nodes)
    if (m.patch[0] >= 0) freedom.of_node[at(m.node)] = m.is_reachable && !m.is_held ? row_of(m.patch) : Freedom::fixed;
  for (const auto node : movement.held) freedom.of_node[at(node)] = Freedom::fixed;
  return freedom;
}

std::vector<LocalId> families_of(const Children& children, const std::vector<LocalId>& cells) {
  std::vector<LocalId> families;
  for (const auto c : cells) {
    const auto lineage = children.lineage[at(c)];
    if (!lineage.is_removable()) continue;
    const auto first = c - lineage.child();
    if (families.empty() || families.back() != first) families.push_back(first);
  }
  return families;
}

std::array<LocalId, 10> parent_nodes(const Children& children, LocalId first) {
  std::array<LocalId, 10> nodes{};
  nodes.fill(-1);
  const auto& pattern = split_pattern[at(children.lineage[at(first)].state())];
  for (int child = 0; child < pattern.n_children; ++child)
    for (std::size_t slot = 0; slot < 4; ++slot)
      nodes[at(pattern.child_to_node[at(child)][slot])] = children.cell_to_node[at(first + child)][slot];
  return nodes;
}

UntangleRegion gather_region(const par::Comm& comm, const NewLevel& level, const Freedom& freedom,
                             const std::vector<LocalId>& cells, int n_layers) {
  auto may_move = reach(comm, level, cells, n_layers);
  const bool reaches_open = any_open(level, may_move);
  for (std::size_t n = 0; n < may_move.size(); ++n)
    if (freedom.of_node[n] == Freedom::fixed) may_move[n] = 0;

  UntangleRegion region;
  region.reaches_open = reaches_open;
  std::vector<LocalId> number(level.n_nodes(), -1);
  const auto number_of = [&](LocalId node) {
    if (number[at(node)] < 0) {
      number[at(node)] = static_cast<LocalId>(region.node.size());
      region.node.push_back(node);
      region.may_move.push_back(may_move[at(node)]);
    }
    return number[at(node)];
  };
  std::vector<LocalId> cells_here;
  for (LocalId c = 0; c < level.n_cells(); ++c) {
    const auto& nodes = level.children.cell_to_node[at(c)];
    if (std::none_of(nodes.begin(), nodes.end(), [&](LocalId n) { return may_move[at(n)] != 0; })) continue;
    cells_here.push_back(c);
    region.cell.push_back({number_of(nodes[0]), number_of(nodes[1]), number_of(nodes[2]), number_of(nodes[3])});
  }
  for (const auto first : families_of(level.children, cells_here)) {
    region.family.push_back(parent_nodes(level.children, first));
    for (auto& node : region.family.back())
      if (node >= 0) node = number_of(node);
  }
  region.cells_of_node = rows_of_nodes(region.cell, region.node.size());
  region.families_of_node = rows_of_nodes(region.family, region.node.size());
  region.shared = par::restricted(level.shared, [&](std::size_t k) {
    const auto node = at(level.shared.item[k]);
    return may_move[node] != 0 ? number[node] : invalid_local;
  });
  return region;
}

}  // namespace pamr::refine
