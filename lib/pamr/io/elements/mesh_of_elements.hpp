// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <string>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/io/elements/element_parts.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Whether cells and nodes are put in order along Hilbert's curve: automatic where that pays (`order::is_ordered`).
enum class CellOrder : std::uint8_t { automatic, keep, curve };

struct ElementOptions {
  Exact<bool> repair = true;  ///< turn inverted cells over; else they are refused, where not all are
  CellOrder order = CellOrder::curve;
  /// Take what prisms, pyramids and quadrangles were cut into (`cut_elements.hpp`); else they are refused.
  Exact<bool> split_prisms = false;
  Exact<bool> with_origin = false;  ///< fill `node_origin`, and `cell_origin` of the mesh
};

/// Elements that a file has in two groups, of which a mesh keeps one.
struct GroupOverlap {
  int dimension = 0;  ///< 2: triangles, 3: tetrahedra
  std::string kept, other;
  std::int64_t n_elements = 0;
  std::string why_kept = "which has the smaller number";  ///< as the end of a sentence
};

/// A group that is no part of a mesh: a named one without any element, or one of points or lines.
struct UnusedGroup {
  int dimension = 0;
  std::string name;
  std::int64_t n_elements = 0;
};

/// A mesh that was read from a file of elements, and what the reader had to change.
struct ElementMesh {
  mesh::DistMesh mesh;
  std::int64_t n_turned = 0;          ///< cells that were inverted
  std::int64_t n_dropped_nodes = 0;   ///< nodes of no tetrahedron: centers of circles, points of the geometry
  std::int64_t n_periodic_links = 0;  ///< that are not kept; their surfaces are patches of kind `periodic`
  /// By patch: faces inside, which have cells on both sides (`mesh/inner_patches.hpp`).
  std::map<std::string, std::int64_t> inner_faces;
  std::int64_t n_untagged_faces = 0;       ///< boundary faces without a tag, which have a patch of that kind
  std::vector<GroupOverlap> overlaps;      ///< each pair of groups once
  std::int64_t n_untagged_triangles = 0;   ///< that no group has: left out
  std::vector<UnusedGroup> unused_groups;  ///< by dimension and number
  std::string why_empty;                   ///< see `ElementParts`
  std::vector<std::string> remarks;        ///< what else was changed or left out
  std::map<int, std::int64_t> cut;         ///< prisms, pyramids and quadrangles that were cut, by `element_type`
  std::vector<std::string> notes;          ///< what lies beside the mesh and is no part of it: nothing strict refuses
  std::vector<GlobalId> node_origin;  ///< of each node of this rank its place among those given; with `with_origin`
};

/// Where elements come from, as messages begin: `file 'part.msh'`.
std::string source_of(const std::filesystem::path& file);

/// Makes a mesh of what a file or arrays say, the one way in for all of them: groups of triangles become patches, in ascending order, with the names and kinds
/// of `patch_of_group`; those of tetrahedra the cell field `region`, with the names of
/// `parts.group_name`. Triangles inside are patches as those of the boundary are. Nodes of no cell are left out. Cells
/// are put in order along Hilbert's curve, or as `options` say.
///
/// Collective; the result does not depend on the number of ranks. `parts.group_name` must be the same on every rank.
/// Throws the same `Error` on every rank, which begins with `source`: by name, with counts, for elements of other kinds,
/// triangles apart from the cells, cells that are inverted (without `repair`), folded or flat,
/// node numbers that are missing, twice or so scattered that no table holds them (more than 64 times as many as nodes).
ElementMesh mesh_of_elements(const par::Comm& comm, ElementParts parts, const std::string& source,
                             const ElementOptions& options,
                             const std::function<mesh::Patch(std::int64_t group)>& patch_of_group);

}  // namespace pamr::io
