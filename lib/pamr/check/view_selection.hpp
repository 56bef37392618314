// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::check {

/// How much of a mesh a view shows. What is beyond is left out of the picture, never out of a report's numbers.
struct ViewLimits {
  std::int64_t faces = 1'000'000;       ///< boundary triangles; of more, near nodes become one until so many are left
  std::int64_t all_cells = 200'000;     ///< up to so many, every cell is in the view
  std::int64_t cut_cells = 200'000;     ///< of larger meshes: cells at the three planes through the middle
  std::int64_t worst_cells = 20;        ///< of lowest mean ratio; with them the cells that share a node with one
  std::int64_t off_surface_nodes = 50;  ///< farthest from their surface
};

/// Box around all nodes with finite coordinates; without any, the origin. Collective: one reduction.
geometry::Box view_box(const par::Comm& comm, const mesh::DistMesh& mesh);

/// A boundary face of this rank.
struct BoundaryFace {
  LocalId cell = invalid_local;
  int slot = 0;
  int patch = 0;
};
/// Those on a patch of the mesh whose cell has finite corners, in the order of cells and slots. Local.
std::vector<BoundaryFace> boundary_faces(const mesh::DistMesh& mesh);

/// Names under which faces know their nodes: global numbers, or where nodes are merged the boxes of a grid, as negative
/// numbers.
class NodeNames {
 public:
  explicit NodeNames(const geometry::Box& box, int boxes_a_side = 0) : box_(&box), boxes_(boxes_a_side) {}
  GlobalId name(const mesh::DistMesh& mesh, Exact<LocalId> node) const;
  bool are_merged() const { return boxes_ > 0; }
  int boxes_a_side() const { return boxes_; }

 private:
  const geometry::Box* box_;
  int boxes_;  ///< 0: nothing is merged
};

/// Removes faces until at most `limit` are left on all ranks: merges nodes in boxes of a grid as fine as may be, and
/// drops the faces that lose a corner. Returns the names of the nodes of the others. Collective: a reduction for each
/// grid that is tried, each 0.8 times as fine as the one before.
NodeNames merge_nodes(const par::Comm& comm, const mesh::DistMesh& mesh, const geometry::Box& box,
                      Exact<std::int64_t> limit, std::vector<BoundaryFace>& faces);

/// One of the cells of lowest mean ratio.
struct WorstCell {
  GlobalId cell = 0;
  double mean_ratio = 0;
  std::array<GlobalId, 4> node{};
};
/// The worst `count`, worst first, on every rank. Collective.
std::vector<WorstCell> find_worst_cells(const par::Comm& comm, const mesh::DistMesh& mesh, Exact<std::int64_t> count);

/// The cells of a view.
struct CellSelection {
  std::vector<LocalId> cell;  ///< of this rank, ascending
  bool is_all = false;        ///< every cell of the mesh
  double window = 1;          ///< the planes are covered in the middle of the box, to this part of its sides
};
/// All cells of a small mesh; of a large one those that touch a plane through the middle of the box, and those that
/// share a node with a worst cell. Collective.
CellSelection select_cells(const par::Comm& comm, const mesh::DistMesh& mesh, const geometry::Box& box,
                           const std::vector<WorstCell>& worst, const ViewLimits& limits);

/// A node of a patch that is not on the patch's surface.
struct OffSurfaceNode {
  GlobalId node = 0;
  std::int64_t patch = 0;
  double distance = 0;  ///< length unit
  geometry::Vec3 position;
};
/// The `count` that are farthest off, by more than `tolerance` (length unit), farthest first, on every rank.
/// Collective.
std::vector<OffSurfaceNode> find_off_surface_nodes(const par::Comm& comm, const mesh::DistMesh& mesh,
                                                   const std::vector<BoundaryFace>& faces, double tolerance,
                                                   std::int64_t count);

}  // namespace pamr::check
