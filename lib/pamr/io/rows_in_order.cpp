// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/io/rows_in_order.hpp"

#include <algorithm>
#include <set>
#include <span>
#include <utility>

#include "pamr/mesh/region_faces.hpp"
#include "pamr/mesh/untagged_patch.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/gather_few.hpp"

namespace pamr::io {

namespace {

mesh::Field in_order(const par::Comm& comm, IdRange all, std::span<const GlobalId> ids, const mesh::Field& field) {
  auto result = mesh::Field{field.name, field.unit, field.n_components, field.storage, {}};
  std::visit(
      [&]<class T>(const std::vector<T>& values) {
        result.value = par::scatter_rows<T>(comm, all, values, static_cast<std::size_t>(field.n_components), ids);
      },
      field.value);
  return result;
}

}  // namespace

RowsInOrder rows_in_order(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::SecondOrder* second_order,
                          Interfaces interfaces) {
  RowsInOrder rows;
  const auto first = mesh.info.first_id;
  const auto& ids = second_order == nullptr ? mesh.node_global : second_order->node_global;
  const auto& position = second_order == nullptr ? mesh.node_position : second_order->node_position;
  const auto all_nodes = second_order == nullptr ? mesh.info.node_ids() : second_order->node_ids(mesh.info);
  rows.n_nodes = all_nodes.n;
  rows.first_node = par::block_range(rows.n_nodes, comm.rank(), comm.size()).begin;
  rows.first_cell = par::block_range(mesh.info.n_global_cells, comm.rank(), comm.size()).begin;
  rows.position = par::scatter_rows<geometry::Vec3>(comm, all_nodes, position, 1, ids);
  std::vector<std::array<GlobalId, 4>> nodes(mesh.cell_to_node.size());
  for (std::size_t c = 0; c < nodes.size(); ++c)
    for (std::size_t i = 0; i < 4; ++i)
      nodes[c][i] = mesh.node_global[static_cast<std::size_t>(mesh.cell_to_node[c][i])] - first;
  rows.cell_to_node =
      par::scatter_rows<std::array<GlobalId, 4>>(comm, mesh.info.cell_ids(), nodes, 1, mesh.cell_global);
  auto groups = group_triangles(comm, mesh, interfaces);
  rows.group_name = std::move(groups.name);
  rows.patch_number = std::move(groups.number);
  rows.group =
      par::scatter_rows<std::array<std::int32_t, 4>>(comm, mesh.info.cell_ids(), groups.of_face, 1, mesh.cell_global);
  if (second_order == nullptr) return rows;
  std::vector<std::array<GlobalId, 6>> mid(mesh.cell_to_node.size());
  for (std::size_t c = 0; c < mid.size(); ++c)
    for (std::size_t e = 0; e < 6; ++e)
      mid[c][e] = ids[static_cast<std::size_t>(second_order->cell_to_mid[c][e])] - first;
  rows.cell_to_mid = par::scatter_rows<std::array<GlobalId, 6>>(comm, mesh.info.cell_ids(), mid, 1, mesh.cell_global);
  return rows;
}

void leave_out_untagged(RowsInOrder& rows, const mesh::MeshInfo& info) {
  const auto untagged = mesh::find_untagged(info.patches);
  if (untagged == info.patches.size()) return;
  for (auto& groups : rows.group)
    std::replace(groups.begin(), groups.end(), static_cast<std::int32_t>(untagged), std::int32_t{-1});
}

mesh::CellField cells_in_order(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::CellField& field) {
  return in_order(comm, mesh.info.cell_ids(), mesh.cell_global, field);
}

mesh::NodeField nodes_in_order(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::NodeField& field) {
  return in_order(comm, mesh.info.node_ids(), mesh.node_global, field);
}

mesh::NodeField nodes_in_order(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::SecondOrder& second_order,
                               const mesh::NodeField& field) {
  return in_order(comm, second_order.node_ids(mesh.info), second_order.node_global, field);
}

std::vector<std::vector<std::size_t>> RegionsInOrder::rows_of_each() const {
  std::vector<std::vector<std::size_t>> rows(all.size());
  for (std::size_t c = 0; c < of_cell.size(); ++c) {
    const auto place = std::lower_bound(all.begin(), all.end(), of_cell[c]);
    if (place != all.end() && *place == of_cell[c]) rows[static_cast<std::size_t>(place - all.begin())].push_back(c);
  }
  return rows;
}

RegionsInOrder regions_in_order(const par::Comm& comm, const mesh::DistMesh& mesh) {
  RegionsInOrder regions;
  const auto* field = mesh::find_regions(mesh);
  regions.has_field = field != nullptr;
  if (!regions.has_field) return regions;
  regions.of_cell = cells_in_order(comm, mesh, *field).integer();
  regions.all = par::gather_distinct(comm, std::set<std::int64_t>(regions.of_cell.begin(), regions.of_cell.end()));
  return regions;
}

}  // namespace pamr::io
