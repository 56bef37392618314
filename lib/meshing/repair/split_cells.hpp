// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <vector>

#include "pamr/geometry/tet_shape.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/region_faces.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::meshing {

inline constexpr int inner_face = -1;  ///< in place of a patch: a face inside that has none

/// A cell, or a part of one that splits have left.
struct CellPart {
  GlobalId cell = 0;             ///< of the old mesh
  std::array<GlobalId, 4> node;  ///< new ones: from the end of the old ones on
  geometry::TetPoints point;
  std::array<int, 4> patch;  ///< of the face opposite each node
};

/// The split of an edge (the third node is -1) or of a face by a new node.
struct Split {
  std::array<GlobalId, 3> node;
  double squared_length = 0;  ///< of the edge
  geometry::Vec3 point;       ///< of the new node

  std::size_t n_nodes() const { return node[2] < 0 ? 2 : 3; }
};

/// The cells of all ranks that hold an edge or a face to be split. Collective; the same on every rank.
std::vector<CellPart> cells_to_split(const par::Comm& comm, const mesh::DistMesh& mesh,
                                     const std::vector<Split>& splits);

/// The cells of all ranks at any of these nodes (ascending). Collective; the same on every rank.
std::vector<CellPart> cells_at(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<GlobalId>& nodes);

/// Nodes of the parts that are neither in the boundary nor between regions, ascending. Collective.
std::vector<GlobalId> inner_nodes(const par::Comm& comm, const mesh::DistMesh& mesh,
                                  const std::vector<mesh::RegionFace>& between, const std::vector<CellPart>& parts);

/// The splits with their new nodes in the middle, in the order in which they are to be made: edges in falling order of
/// length, then faces. `cells` hold all their nodes.
std::vector<Split> placed_in_order(const std::vector<CellPart>& cells, std::vector<Split> splits);

/// What becomes of each of the cells, by cell; cells without a split stay whole. The new node of split `s` gets the
/// number `first_new + s`.
std::map<GlobalId, std::vector<CellPart>> split_cells(const std::vector<CellPart>& cells,
                                                      const std::vector<Split>& splits, GlobalId first_new);

}  // namespace pamr::meshing
