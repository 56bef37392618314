// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/io/elements/element_parts.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

struct ElementOptions {
  Exact<bool> repair = false;  ///< turn inverted cells over instead of refusing them, where not all are
};

/// Elements that a file has in two groups, of which a mesh keeps one.
struct GroupOverlap {
  int dimension = 0;  ///< 2: triangles, 3: tetrahedra
  std::string kept, other;
  std::int64_t n_elements = 0;
};

/// A mesh that was read from a file of elements, and what the reader had to change.
struct ElementMesh {
  mesh::DistMesh mesh;
  std::int64_t n_turned = 0;          ///< cells that were inverted
  std::int64_t n_dropped_nodes = 0;   ///< nodes of no tetrahedron: centers of circles, points of the geometry
  std::int64_t n_periodic_links = 0;  ///< that are not kept; their surfaces are patches of kind `periodic`
  /// By group: triangles between two regions, which are no patch; `write_gmsh` and `write_medit` can make them again.
  std::map<std::string, std::int64_t> inner_faces;
  std::int64_t n_untagged_faces = 0;   ///< boundary faces without triangle: they are in the patch `boundary`
  std::vector<GroupOverlap> overlaps;  ///< each pair of groups once
};

/// Makes a mesh of what a file says: groups of triangles become patches, in ascending order, with the names and kinds
/// of `patch_of_group`; those of tetrahedra the cell field `region` (0 for those below), with the names of
/// `parts.group_name`. Nodes of no cell and triangles between two regions are left out. Cells are put in order along
/// Hilbert's curve.
///
/// Collective; the result does not depend on the number of ranks. `parts.group_name` must be the same on every rank.
/// Throws the same `Error` on every rank, with the name of the file: by name, with counts, for elements of other kinds,
/// triangles inside a region or apart from the cells, cells that are inverted (unless `repair`) or flat,
/// node numbers that are missing, twice or so scattered that no table holds them (more than 64 times as many as nodes).
ElementMesh mesh_of_elements(const par::Comm& comm, ElementParts parts, const std::string& file,
                             const ElementOptions& options,
                             const std::function<mesh::Patch(std::int64_t group)>& patch_of_group);

}  // namespace pamr::io
