// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// One rank's canonical blocks of the nodes and cells of a mesh, as formats that number by place want them: node and
/// cell numbers from 0 on.
struct RowsInOrder {
  GlobalId first_node = 0, first_cell = 0;
  std::vector<geometry::Vec3> position;
  std::vector<std::array<GlobalId, 4>> cell_to_node;
  std::vector<std::array<std::int32_t, 4>> patch;  ///< of each face, -1 inside
};

/// Collective: sparse exchanges, O(cells / ranks) bytes a rank.
RowsInOrder rows_in_order(const par::Comm& comm, const mesh::DistMesh& mesh);

/// The values of a field in that order. Collective.
mesh::CellField cells_in_order(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::CellField& field);
mesh::NodeField nodes_in_order(const par::Comm& comm, const mesh::DistMesh& mesh, const mesh::NodeField& field);

/// The values of the cell field `region` in that order, and all that there are.
struct RegionsInOrder {
  bool has_field = false;             ///< where it is an integer field of one component; else nothing else is set
  std::vector<std::int64_t> of_cell;  ///< of this rank's canonical block
  std::vector<std::int64_t> all;      ///< ascending, the same on every rank
};
/// Collective.
RegionsInOrder regions_in_order(const par::Comm& comm, const mesh::DistMesh& mesh);

/// The name of a region, empty where it has none.
std::string name_of_region(const mesh::MeshInfo& info, std::int64_t number);

}  // namespace pamr::io
