// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/order/order_here.hpp"

#include <limits>
#include <utility>

#include "pamr/base/memory.hpp"
#include "pamr/base/prefetch.hpp"
#include "pamr/base/sorted_order.hpp"
#include "pamr/mesh/families.hpp"
#include "pamr/order/order_nodes.hpp"

// On one rank ordering is a matter of memory traffic: every array is read once in the new order and written once from
// front to back. Rows are asked for some rows ahead, what they point to half as far ahead.

namespace pamr::order {

namespace {

constexpr std::size_t rows_ahead = 24;
constexpr std::uint32_t no_number = std::numeric_limits<std::uint32_t>::max();

std::vector<std::uint64_t> find_keys(const mesh::BlockMesh& block, const CurveGrid& grid) {
  const auto n = block.cell_to_node.size();
  const auto point = [&](GlobalId node) -> const geometry::Vec3& {
    return block.node_position[static_cast<std::size_t>(node - block.info.first_id)];
  };
  std::vector<std::uint64_t> key;
  reserve_array(key, n);
  for (std::size_t c = 0; c < n; ++c) {
    if (c + rows_ahead < n)
      for (const auto node : block.cell_to_node[c + rows_ahead]) prefetch(&point(node));
    if (c > 0 && !block.lineage.empty() && mesh::follows_in_tree(block.lineage[c - 1], block.lineage[c])) {
      key.push_back(key.back());
      continue;
    }
    const auto& nodes = block.cell_to_node[c];
    key.push_back(key_of(grid, {point(nodes[0]), point(nodes[1]), point(nodes[2]), point(nodes[3])}));
  }
  return key;
}

std::vector<std::uint32_t> inverse(const std::vector<std::uint32_t>& new_to_old) {
  std::vector<std::uint32_t> old_to_new;
  assign_array(old_to_new, new_to_old.size(), no_number);
  for (std::size_t i = 0; i < new_to_old.size(); ++i) {
    if (i + rows_ahead < new_to_old.size()) prefetch(&old_to_new[new_to_old[i + rows_ahead]]);
    old_to_new[new_to_old[i]] = static_cast<std::uint32_t>(i);
  }
  return old_to_new;
}

template <class T>
void reorder(std::vector<T>& rows, std::size_t width, const std::vector<std::uint32_t>& new_to_old) {
  std::vector<T> result;
  reserve_array(result, rows.size());
  for (std::size_t i = 0; i < new_to_old.size(); ++i) {
    if (i + rows_ahead < new_to_old.size()) prefetch(&rows[new_to_old[i + rows_ahead] * width]);
    const auto row = rows.begin() + static_cast<std::ptrdiff_t>(new_to_old[i] * width);
    for (std::size_t k = 0; k < width; ++k) result.push_back(row[static_cast<std::ptrdiff_t>(k)]);
  }
  rows = std::move(result);
}

void reorder(std::vector<mesh::Field>& fields, const std::vector<std::uint32_t>& new_to_old) {
  for (auto& field : fields)
    std::visit([&](auto& values) { reorder(values, static_cast<std::size_t>(field.n_components), new_to_old); },
               field.value);
}

/// Puts the cells into the new order and numbers their nodes; returns the new order of the nodes.
std::vector<std::uint32_t> reorder_corners(mesh::BlockMesh& block, const std::vector<std::uint32_t>& new_to_old) {
  const auto n = new_to_old.size();
  const auto first = block.info.first_id;
  const auto& old = block.cell_to_node;
  std::vector<std::array<GlobalId, 4>> result;
  reserve_array(result, n);
  std::vector<std::uint32_t> old_to_new, node_to_old;
  assign_array(old_to_new, block.node_position.size(), no_number);
  reserve_array(node_to_old, block.node_position.size());
  for (std::size_t i = 0; i < n; ++i) {
    if (i + rows_ahead < n) prefetch(&old[new_to_old[i + rows_ahead]]);
    if (i + rows_ahead / 2 < n)
      for (const auto node : old[new_to_old[i + rows_ahead / 2]])
        prefetch(&old_to_new[static_cast<std::size_t>(node - first)]);
    auto nodes = old[new_to_old[i]];
    for (auto& node : nodes) {
      auto& number = old_to_new[static_cast<std::size_t>(node - first)];
      if (number == no_number) {
        number = static_cast<std::uint32_t>(node_to_old.size());
        node_to_old.push_back(static_cast<std::uint32_t>(node - first));
      }
      node = first + static_cast<GlobalId>(number);
    }
    result.push_back(nodes);
  }
  block.cell_to_node = std::move(result);
  for (std::size_t node = 0; node < old_to_new.size(); ++node)
    if (old_to_new[node] == no_number) node_to_old.push_back(static_cast<std::uint32_t>(node));
  return node_to_old;
}

void reorder_neighbors(mesh::BlockMesh& block, const std::vector<std::uint32_t>& new_to_old) {
  const auto old_to_new = inverse(new_to_old);
  const auto n = new_to_old.size();
  const auto first = block.info.first_id;
  const auto& old = block.cell_to_cell;
  std::vector<std::array<GlobalId, 4>> result;
  reserve_array(result, n);
  for (std::size_t i = 0; i < n; ++i) {
    if (i + rows_ahead < n) prefetch(&old[new_to_old[i + rows_ahead]]);
    if (i + rows_ahead / 2 < n)
      for (const auto cell : old[new_to_old[i + rows_ahead / 2]])
        if (cell >= 0) prefetch(&old_to_new[static_cast<std::size_t>(cell - first)]);
    auto cells = old[new_to_old[i]];
    for (auto& cell : cells)
      if (cell >= 0) cell = first + static_cast<GlobalId>(old_to_new[static_cast<std::size_t>(cell - first)]);
    result.push_back(cells);
  }
  block.cell_to_cell = std::move(result);
}

void reorder_triangles(mesh::BlockMesh& block, const std::vector<std::uint32_t>& node_to_old) {
  const auto old_to_new = inverse(node_to_old);
  const auto first = block.info.first_id;
  for (auto& corners : block.boundary.node)
    for (auto& node : corners) node = first + static_cast<GlobalId>(old_to_new[static_cast<std::size_t>(node - first)]);
}

std::vector<GlobalId> origins(const std::vector<std::uint32_t>& new_to_old, GlobalId first) {
  std::vector<GlobalId> origin;
  reserve_array(origin, new_to_old.size());
  for (const auto old : new_to_old) origin.push_back(first + static_cast<GlobalId>(old));
  return origin;
}

}  // namespace

Ordered order_here(mesh::BlockMesh block, const CurveGrid& grid) {
  auto new_to_old = sorted_order(find_keys(block, grid));
  const auto node_to_old = reorder_corners(block, new_to_old);
  if (!block.cell_to_cell.empty()) reorder_neighbors(block, new_to_old);
  if (!block.boundary.node.empty()) reorder_triangles(block, node_to_old);
  if (!block.lineage.empty()) reorder(block.lineage, 1, new_to_old);
  if (!block.cell_origin.empty()) reorder(block.cell_origin, 1, new_to_old);
  reorder(block.cell_fields, new_to_old);
  reorder(block.node_position, 1, node_to_old);
  reorder(block.node_fields, node_to_old);
  Ordered ordered;
  ordered.cell_origin = origins(new_to_old, block.info.first_id);
  ordered.node_origin = origins(node_to_old, block.info.first_id);
  ordered.block = std::move(block);
  return ordered;
}

}  // namespace pamr::order
