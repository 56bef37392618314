// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/repair/weld.hpp"

#include <array>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "pamr/assemble/assemble.hpp"
#include "pamr/base/index.hpp"
#include "pamr/check/tears.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/renumber.hpp"

namespace pamr::meshing {

namespace {

/// The same field with the values of some rows, moved to their blocks. Collective.
mesh::Field moved(const par::Comm& comm, const mesh::Field& field, const std::vector<LocalId>& rows, IdRange to,
                  const std::vector<GlobalId>& number) {
  auto result = field;
  const auto width = at(field.n_components);
  std::visit(
      [&](auto& values) {
        using T = typename std::decay_t<decltype(values)>::value_type;
        std::decay_t<decltype(values)> chosen;
        for (const auto row : rows)
          for (std::size_t k = 0; k < width; ++k) chosen.push_back(values[at(row) * width + k]);
        values = par::scatter_rows<T>(comm, to, chosen, width, number);
      },
      result.value);
  return result;
}

void add_boundary(const mesh::DistMesh& mesh, const check::PairedFaces& faces, const std::vector<GlobalId>& number,
                  mesh::BoundaryTriangles& boundary) {
  for (std::size_t i = 0; i < faces.face.size(); ++i) {
    if (faces.is_paired[i] != 0) continue;
    const auto [cell, slot] = faces.face[i];
    auto& node = boundary.node.emplace_back();
    for (std::size_t k = 0; k < 3; ++k)
      node[k] = number[at(mesh.cell_to_node[at(cell)][at(mesh::tet::face_to_corner[at(slot)][k])])];
    boundary.patch.push_back(mesh::slot_to_patch(mesh.cell_to_cell[at(cell)][at(slot)]));
  }
}

}  // namespace

mesh::DistMesh weld(const par::Comm& comm, mesh::DistMesh mesh) {
  mesh::drop_level0(mesh);  // it is that of another level 0
  const auto by_place = check::nodes_by_place(comm, mesh);
  auto [n_kept, number] = par::renumber(comm, mesh.info.node_ids(), by_place);
  std::vector<LocalId> kept;
  std::vector<GlobalId> number_of_kept;
  for (auto& one : number) one += mesh.info.first_id;
  for (LocalId node = 0; node < mesh.n_nodes(); ++node) {
    if (by_place[at(node)] != mesh.node_global[at(node)]) continue;
    kept.push_back(node);
    number_of_kept.push_back(number[at(node)]);
  }
  mesh::BlockMesh block;
  block.info = mesh.info;
  block.info.n_global_nodes = n_kept;
  const auto cell_ids = block.info.cell_ids(), node_ids = block.info.node_ids();
  block.first_cell = par::block_range(cell_ids, comm.rank(), comm.size()).begin;
  std::vector<LocalId> cells;
  std::vector<std::array<GlobalId, 4>> corners;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    cells.push_back(c);
    auto& corner = corners.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) corner[k] = number[at(mesh.cell_to_node[at(c)][k])];
  }
  block.cell_to_node = par::scatter_rows<std::array<GlobalId, 4>>(comm, cell_ids, corners, 1, mesh.cell_global);
  if (comm.any(!mesh.cell_origin.empty()))
    block.cell_origin = par::scatter_rows<GlobalId>(comm, cell_ids, mesh.cell_origin, 1, mesh.cell_global);
  for (const auto& field : mesh.cell_fields)
    block.cell_fields.push_back(moved(comm, field, cells, cell_ids, mesh.cell_global));
  std::vector<geometry::Vec3> positions;
  for (const auto node : kept) positions.push_back(mesh.point(node));
  block.node_position = par::scatter_rows<geometry::Vec3>(comm, node_ids, positions, 1, number_of_kept);
  for (const auto& field : mesh.node_fields)
    block.node_fields.push_back(moved(comm, field, kept, node_ids, number_of_kept));
  add_boundary(mesh, check::pair_faces(comm, mesh, by_place), number, block.boundary);
  return assemble::assemble(comm, std::move(block));
}

}  // namespace pamr::meshing
