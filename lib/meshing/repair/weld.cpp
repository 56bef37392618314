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
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"

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

/// The nodes that are left, with new numbers.
struct Kept {
  GlobalId n = 0;                        ///< on all ranks
  std::vector<GlobalId> number;          ///< of each node of this rank the new number of the one in its place
  std::vector<LocalId> node;             ///< of this rank
  std::vector<GlobalId> number_of_node;  ///< of these
};

Kept number_kept(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<GlobalId>& by_place) {
  const auto ids = mesh.info.node_ids();
  const auto in_block = par::scatter_rows<GlobalId>(comm, ids, by_place, 1, mesh.node_global);
  const auto begin = par::block_range(ids, comm.rank(), comm.size()).begin;
  std::vector<GlobalId> number(in_block.size(), 0);
  std::int64_t n = 0;
  for (std::size_t i = 0; i < in_block.size(); ++i)
    if (in_block[i] == begin + static_cast<GlobalId>(i)) number[i] = n++;
  const auto before = mesh.info.first_id + comm.exclusive_sum(n);
  for (auto& one : number) one += before;
  Kept kept{comm.sum(n), par::fetch_rows<GlobalId>(comm, ids, number, 1, by_place), {}, {}};
  for (LocalId node = 0; node < mesh.n_nodes(); ++node) {
    if (by_place[at(node)] != mesh.node_global[at(node)]) continue;
    kept.node.push_back(node);
    kept.number_of_node.push_back(kept.number[at(node)]);
  }
  return kept;
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

mesh::DistMesh weld(const par::Comm& comm, const mesh::DistMesh& mesh) {
  const auto by_place = check::nodes_by_place(comm, mesh);
  const auto kept = number_kept(comm, mesh, by_place);
  mesh::BlockMesh block;
  block.info = mesh.info;
  block.info.n_global_nodes = kept.n;
  block.info.level0 = nullptr;
  const auto cell_ids = block.info.cell_ids(), node_ids = block.info.node_ids();
  block.first_cell = par::block_range(cell_ids, comm.rank(), comm.size()).begin;
  std::vector<LocalId> cells;
  std::vector<std::array<GlobalId, 4>> corners;
  for (LocalId c = 0; c < mesh.n_cells(); ++c) {
    cells.push_back(c);
    auto& corner = corners.emplace_back();
    for (std::size_t k = 0; k < 4; ++k) corner[k] = kept.number[at(mesh.cell_to_node[at(c)][k])];
  }
  block.cell_to_node = par::scatter_rows<std::array<GlobalId, 4>>(comm, cell_ids, corners, 1, mesh.cell_global);
  if (comm.any(!mesh.cell_origin.empty()))
    block.cell_origin = par::scatter_rows<GlobalId>(comm, cell_ids, mesh.cell_origin, 1, mesh.cell_global);
  for (const auto& field : mesh.cell_fields)
    block.cell_fields.push_back(moved(comm, field, cells, cell_ids, mesh.cell_global));
  std::vector<geometry::Vec3> positions;
  for (const auto node : kept.node) positions.push_back(mesh.point(node));
  block.node_position = par::scatter_rows<geometry::Vec3>(comm, node_ids, positions, 1, kept.number_of_node);
  for (const auto& field : mesh.node_fields)
    block.node_fields.push_back(moved(comm, field, kept.node, node_ids, kept.number_of_node));
  add_boundary(mesh, check::pair_faces(comm, mesh, by_place), kept.number, block.boundary);
  return assemble::assemble(comm, std::move(block));
}

}  // namespace pamr::meshing
