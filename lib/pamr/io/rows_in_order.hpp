// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pamr/io/interfaces.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/second_order.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// One rank's canonical blocks of the nodes and cells of a mesh, as formats that number by place want them: node and
/// cell numbers from 0 on.
struct RowsInOrder {
  GlobalId n_nodes = 0;  ///< of all ranks, mid-edge nodes included
  GlobalId first_node = 0, first_cell = 0;
  std::vector<geometry::Vec3> position;
  std::vector<std::array<GlobalId, 4>> cell_to_node;
  std::vector<std::array<GlobalId, 6>>
      cell_to_mid;                                 ///< mid-edge nodes, edges as in `mesh/tet.hpp`; of second order only
  std::vector<std::array<std::int32_t, 4>> group;  ///< of each face: an index into `group_name`, -1 for none
  std::vector<std::string> group_name;             ///< of patches, then of interfaces
  std::vector<std::int64_t> patch_number;          ///< of patches: `mesh::Patch::number`

  /// The mid-edge node between two corners of a cell.
  GlobalId mid(std::size_t cell, int corner_a, int corner_b) const {
    return cell_to_mid[cell][static_cast<std::size_t>(
        mesh::tet::edge_of[static_cast<std::size_t>(corner_a)][static_cast<std::size_t>(corner_b)])];
  }
};

/// `second_order`: null for linear cells. Collective: sparse exchanges, O(cells / ranks) bytes a rank.
RowsInOrder rows_in_order(const par::Comm& comm, const mesh::DistMesh& mesh,
                          const mesh::SecondOrder* second_order = nullptr, Interfaces interfaces = Interfaces::none);

/// Leaves out the faces without a tag, for formats that allow that: they get the group -1. Local.
void leave_out_untagged(RowsInOrder& rows, const mesh::MeshInfo& info);

/// The values of a field in that order. Collective.
mesh::CellField cells_in_order(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::CellField& field);
mesh::NodeField nodes_in_order(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::NodeField& field);
/// The same of a field on all nodes of second order. Collective.
mesh::NodeField nodes_in_order(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::SecondOrder& second_order,
                               const mesh::NodeField& field);

/// The values of the cell field `region` in that order, and all that there are.
struct RegionsInOrder {
  bool has_field = false;             ///< where it is an integer field of one component; else nothing else is set
  std::vector<std::int64_t> of_cell;  ///< of this rank's canonical block
  std::vector<std::int64_t> all;      ///< ascending, the same on every rank

  /// Of each of `all` the rows of `of_cell` that have it.
  std::vector<std::vector<std::size_t>> rows_of_each() const;
};
/// Collective.
RegionsInOrder regions_in_order(const par::Comm& comm, const mesh::DistMesh& mesh);

}  // namespace pamr::io
