// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pamr/check/view_selection.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::check {

/// Values of the nodes, cells or faces of a view; of a vector its length, named |NAME|.
struct ViewColumn {
  std::string name, unit;
  bool is_integer = false;
  std::vector<double> value;
};

struct ViewNodes {
  std::vector<GlobalId> number;  ///< in the mesh
  std::vector<geometry::Vec3> position;
  std::vector<ViewColumn> columns;  ///< the nodal fields
};

struct ViewCells {
  std::vector<GlobalId> number;                   ///< in the mesh, ascending
  std::vector<std::array<std::int64_t, 4>> node;  ///< indices of `ViewNodes`
  std::vector<ViewColumn> columns;                ///< level, shape, cell fields; those most asked for first
};

struct ViewFaces {
  std::vector<GlobalId> cell;                     ///< behind the face: its number in the mesh, ascending
  std::vector<std::array<std::int64_t, 3>> node;  ///< indices of `ViewNodes`, counter-clockwise from outside
  std::vector<std::int64_t> patch;
  std::vector<ViewColumn> columns;  ///< those of the cell, and the distances from the patch's surface
};

/// What a picture of a mesh is drawn from: the boundary, and cells for sections.
struct MeshView {
  geometry::Box box;
  ViewNodes nodes;
  ViewCells cells;
  ViewFaces faces;
  std::vector<mesh::Patch> patches;
  std::vector<std::string> surface_of_patch;  ///< name, or empty
  std::string length_unit;
  std::vector<WorstCell> worst;
  std::vector<OffSurfaceNode> off_surface;
  bool has_all_cells = false;  ///< else those at the three middle planes and around the worst cells
  double window = 1;           ///< see `CellSelection`
  bool nodes_are_merged = false;
};

/// Gathers a view of a mesh on rank 0; other ranks get the box, the lists of the worst and what is said once. The same
/// for every number of ranks. `tolerance`: distance beyond which a node is off its surface, length unit.
/// Collective. Rank 0 needs memory for what the limits allow: about 100 bytes and 8 for each field, times the faces.
MeshView view_mesh(const par::Comm& comm, const mesh::DistMesh& mesh, double tolerance, const ViewLimits& limits = {});

}  // namespace pamr::check
