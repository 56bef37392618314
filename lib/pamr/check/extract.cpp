// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/extract.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/contract.hpp"
#include "pamr/check/metrics.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/renumber.hpp"
#include "pamr/par/select_smallest.hpp"

namespace pamr::check {

namespace {

mesh::CellField cell_field(std::string name, mesh::StorageType storage) {
  mesh::CellField field;
  field.name = std::move(name);
  field.storage = storage;
  if (mesh::is_integer(storage)) field.value = std::vector<std::int64_t>{};
  return field;
}

}  // namespace

std::vector<std::uint8_t> worst_cells(const par::Comm& comm, const mesh::DistMesh& mesh, Exact<std::int64_t> count) {
  std::vector<par::SortKey> key;
  key.reserve(mesh.cell_to_node.size());
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    auto p = mesh.points(cell);
    const double quality = geometry::mean_ratio(p);
    std::sort(p.begin(), p.end(), geometry::lexicographically_less);
    const auto sum = ((p[0] + p[1]) + p[2]) + p[3];
    key.push_back({par::ordered_bits(quality), par::ordered_bits(sum.x), par::ordered_bits(sum.y),
                   par::ordered_bits(sum.z),
                   static_cast<std::uint64_t>(mesh.cell_global[static_cast<std::size_t>(cell)])});
  }
  return par::select_smallest(comm, key, count);
}

mesh::DistMesh extract_cells(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::uint8_t> chosen) {
  PAMR_EXPECTS(chosen.size() == mesh.cell_to_node.size());
  std::vector<GlobalId> cell_ids, node_ids;
  std::vector<std::int64_t> level;
  std::vector<LocalId> cells, nodes;
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto c = static_cast<std::size_t>(cell);
    if (chosen[c] == 0) continue;
    cells.push_back(cell);
    cell_ids.push_back(mesh.cell_global[c]);
    level.push_back(mesh.lineage[c].level());
    nodes.insert(nodes.end(), mesh.cell_to_node[c].begin(), mesh.cell_to_node[c].end());
  }
  for (const LocalId node : nodes) node_ids.push_back(mesh.node_global[static_cast<std::size_t>(node)]);

  const auto new_cell = par::renumber(comm, mesh.info.cell_ids(), cell_ids);
  const auto new_node = par::renumber(comm, mesh.info.node_ids(), node_ids);
  std::vector<double> metric, position;
  for (const LocalId cell : cells) {
    const auto value = cell_metrics(mesh.points(cell));
    metric.insert(metric.end(), value.begin(), value.end());
  }
  for (const LocalId node : nodes) {
    const auto p = mesh.point(node);
    position.insert(position.end(), {p.x, p.y, p.z});
  }

  mesh::BlockMesh block;
  block.info.n_global_nodes = new_node.n;
  block.info.n_global_cells = new_cell.n;
  block.info.patches = {{"cut", ""}};
  block.info.length_unit = mesh.info.length_unit;
  block.first_cell = par::block_range(new_cell.n, comm.rank(), comm.size()).begin;
  const auto corner = par::scatter_rows<GlobalId>(comm, new_cell.n, new_node.new_id, 4, new_cell.new_id);
  for (std::size_t i = 0; i < corner.size(); i += 4)
    block.cell_to_node.push_back({corner[i], corner[i + 1], corner[i + 2], corner[i + 3]});
  const auto x = par::scatter_rows<double>(comm, new_node.n, position, 3, new_node.new_id);
  for (std::size_t i = 0; i < x.size(); i += 3) block.node_position.push_back({x[i], x[i + 1], x[i + 2]});

  auto old_cell = cell_field("cell", mesh::StorageType::int64);
  old_cell.integer() = par::scatter_rows<GlobalId>(comm, new_cell.n, cell_ids, 1, new_cell.new_id);
  auto cell_level = cell_field(mesh::level_field, mesh::StorageType::int32);
  cell_level.integer() = par::scatter_rows<std::int64_t>(comm, new_cell.n, level, 1, new_cell.new_id);
  block.cell_fields = {std::move(old_cell), std::move(cell_level)};
  const auto metric_rows = par::scatter_rows<double>(comm, new_cell.n, metric, 6, new_cell.new_id);
  for (std::size_t m = 0; m < metric_names().size(); ++m) {
    auto field = cell_field(metric_names()[m], mesh::StorageType::float64);
    for (std::size_t i = m; i < metric_rows.size(); i += 6) field.real().push_back(metric_rows[i]);
    block.cell_fields.push_back(std::move(field));
  }
  return assemble::assemble(comm, std::move(block));
}

}  // namespace pamr::check
