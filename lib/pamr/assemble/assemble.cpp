// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/assemble/assemble.hpp"

#include <fmt/format.h>

#include <string>
#include <utility>

#include "pamr/assemble/build_neighbors.hpp"
#include "pamr/assemble/check_block.hpp"
#include "pamr/assemble/link_neighbors.hpp"
#include "pamr/assemble/send_cells.hpp"
#include "pamr/assemble/tag_boundary.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/families.hpp"
#include "pamr/mesh/first_use.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/mesh/local_size.hpp"
#include "pamr/mesh/untagged_patch.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::assemble {

namespace {

/// Numbers the nodes in order of first use and fills `cell_to_node` and `node_global`.
void number_nodes(mesh::DistMesh& mesh, const std::vector<std::array<GlobalId, 4>>& cell_to_node) {
  assign_array(mesh.cell_to_node, cell_to_node.size(), {});
  mesh.node_global = mesh::nodes_by_first_use(
      cell_to_node, [&](std::size_t c, std::size_t i, LocalId place) { mesh.cell_to_node[c][i] = place; });
  mesh.node_global.shrink_to_fit();
}

/// Coordinates and node fields of this rank's nodes, from the blocks that hold them.
void fetch_nodes(const par::Comm& comm, mesh::DistMesh& mesh, mesh::BlockMesh& block) {
  const auto all = mesh.info.node_ids();
  mesh.node_position = par::fetch_rows<geometry::Vec3>(comm, all, block.node_position, 1, mesh.node_global);
  free_array(block.node_position);
  for (auto& field : block.node_fields) {
    std::visit(
        [&]<class T>(std::vector<T>& values) {
          values =
              par::fetch_rows<T>(comm, all, values, static_cast<std::size_t>(field.n_components), mesh.node_global);
        },
        field.value);
    mesh.node_fields.push_back(std::move(field));
  }
}

/// Refuses families whose cells do not share their nodes as the template says. They are whole and on one rank by now.
void check_templates(const mesh::DistMesh& mesh) {
  for (std::size_t c = 0; c < mesh.lineage.size();) {
    const auto lineage = mesh.lineage[c];
    if (!lineage.is_removable()) {
      ++c;
      continue;
    }
    const auto size = static_cast<std::size_t>(lineage.family_size());
    if (!mesh::fits_template(lineage, std::span<const mesh::CellNodes>(mesh.cell_to_node).subspan(c, size)))
      throw Error(
          fmt::format("lineage: expected cells {} to {} to share their nodes as one closure family, found other nodes "
                      "(first cell: {})",
                      mesh.cell_global[c], mesh.cell_global[c + size - 1], mesh::describe(lineage)));
    c += size;
  }
}

}  // namespace

mesh::DistMesh assemble(const par::Comm& comm, mesh::BlockMesh block, std::span<const Rank> destination) {
  const auto contents = check_block(comm, block, destination);
  auto cells = send_cells(comm, block, family_destinations(comm, block, destination, contents), contents);
  mesh::require_local_size(comm, std::ssize(cells.id), "mesh");

  mesh::DistMesh mesh;
  mesh.info = std::move(block.info);
  mesh.cell_global = std::move(cells.id);
  mesh.lineage = std::move(cells.lineage);
  mesh.cell_origin = std::move(cells.origin);
  mesh.cell_fields = std::move(cells.field);
  number_nodes(mesh, cells.node);
  free_array(cells.node);
  par::agree(comm, [&] { check_templates(mesh); });
  if (contents.has_neighbors) {
    const auto owners = find_owners(comm, mesh.info.cell_ids(), mesh.cell_global, contents);
    link_neighbors(comm, mesh, std::move(cells.neighbor), owners);
    if (contents.has_boundary) compare_boundary(comm, mesh, block.boundary);
  } else {
    if (mesh.info.patches.empty()) mesh.info.patches.push_back(mesh::untagged_patch({}));
    build_neighbors(comm, mesh);
    if (contents.has_boundary) tag_boundary(comm, mesh, block.boundary);
  }
  fetch_nodes(comm, mesh, block);
  mesh::send_level0_rows(comm, mesh);
  return mesh;
}

}  // namespace pamr::assemble
