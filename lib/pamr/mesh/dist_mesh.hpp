// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/base/types.hpp"
#include "pamr/geometry/surface_set.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/field.hpp"
#include "pamr/mesh/lineage.hpp"

namespace pamr::mesh {

class Level0Map;

using CellNodes = std::array<LocalId, 4>;
using CellNeighbors = std::array<LocalId, 4>;

/// A group that the user has put faces or cells in.
struct Group {
  std::int64_t number = -1;  ///< -1: none
  std::string name;
  friend bool operator==(const Group&, const Group&) = default;
};

/// A named part of the boundary, or of the faces inside (`inner_patches.hpp`).
struct Patch {
  std::string name;
  std::string kind;
  int surface = -1;          ///< that it lies on, an index into `MeshInfo::surfaces`; -1: none, nothing to project onto
  std::int64_t number = -1;  ///< that the user gave it: of a physical group, a reference, a tag; -1: none
  std::int64_t condition = 0;  ///< of FUN3D, from a `.mapbc`; 0: none
  /// The user's groups that its faces are in where these are several; empty: the patch is its only group.
  std::vector<Group> groups = {};
  friend bool operator==(const Patch&, const Patch&) = default;
};

/// The name of a part of the domain: of the cells whose integer field `region_field` has that value.
struct Region {
  std::int64_t number = 0;
  std::string name;
  std::vector<Group> groups = {};  ///< as of a patch
  friend bool operator==(const Region&, const Region&) = default;
};

/// Cell field of the parts of the domain, 0 for cells of none.
inline constexpr const char* region_field = "region";

/// What is said once for the whole mesh; the same on every rank.
struct MeshInfo {
  GlobalId n_global_nodes = 0;
  GlobalId n_global_cells = 0;
  std::vector<Patch> patches;
  std::vector<Region> regions;                                  ///< those with a name, ascending by number
  geometry::SharedSurfaces surfaces = geometry::no_surfaces();  ///< never null; shared, never changed
  /// Where new nodes near coarse curved walls belong (`mesh/level0_map.hpp`), with this rank's rows; null: there are
  /// none, or level 0 was not split yet.
  std::shared_ptr<const Level0Map> level0;
  std::string length_unit;
  std::string provenance;
  /// Number of the first cell and of the first node: the global numbers run from here on without gaps. 0 but for parts
  /// of larger meshes and for tests of large numbers; below `max_first_id`.
  GlobalId first_id = 0;
  /// Known: cut faces of the families (`refine/cut_faces.hpp`) are faces of whole families on both sides. Set by
  /// refinements that leave it so, and not written to files; where it is not known, the next one looks.
  bool cut_faces_conform = false;

  /// The surface that a patch lies on, or null.
  const geometry::Surface* surface_of(Exact<int> patch) const;
  /// Its name, or an empty text.
  std::string surface_name(const Patch& patch) const;
  IdRange cell_ids() const { return {n_global_cells, first_id}; }
  IdRange node_ids() const { return {n_global_nodes, first_id}; }
};

/// Four times the sum of this and of a count of cells fits 64 bits.
inline constexpr GlobalId max_first_id = GlobalId{1} << 53U;

/// A face of a cell: the one opposite corner `slot`.
struct CellFace {
  LocalId cell = invalid_local;
  int slot = 0;
  friend bool operator==(CellFace, CellFace) = default;
};

/// One rank's part of a tetrahedral mesh: structures of arrays, 32-bit local and 64-bit global ids, no edges.
///
/// Cells are all owned and ascend in global id; closure families are whole and contiguous. A neighbor slot holds an
/// owned cell (0 .. n_cells-1), a face ghost (n_cells + k: rank-border face k, whose other cell is `ghost_global[k]` on
/// another rank) or a boundary patch (-(patch+1)). Rank-border faces are grouped by rank, ranks ascending, and listed
/// in the same order on both sides. Nodes on a rank border are held by every rank that has a cell at them, with equal
/// coordinates. At rest: 48 bytes a cell and 32 bytes a node.
struct DistMesh {
  MeshInfo info;

  std::vector<geometry::Vec3> node_position;  ///< n_nodes, length unit
  std::vector<GlobalId> node_global;          ///< n_nodes

  std::vector<CellNodes> cell_to_node;      ///< n_cells x 4, local ids
  std::vector<CellNeighbors> cell_to_cell;  ///< n_cells x 4, see above
  std::vector<GlobalId> cell_global;        ///< n_cells, ascending
  std::vector<Lineage> lineage;             ///< n_cells
  std::vector<GlobalId> cell_origin;        ///< n_cells: numbers in the file; empty on every rank: `cell_global`

  std::vector<Rank> border_rank;  ///< ranks that share a face with this one, ascending
  std::vector<std::size_t> border_offset{
      0};                              ///< border faces of border_rank[i]: border_offset[i] .. border_offset[i+1]
  std::vector<CellFace> border_face;   ///< own side of each rank-border face
  std::vector<GlobalId> ghost_global;  ///< cell on the other side

  std::vector<NodeField> node_fields;  ///< values of n_nodes
  std::vector<CellField> cell_fields;  ///< values of n_cells

  LocalId n_nodes() const { return static_cast<LocalId>(node_position.size()); }
  LocalId n_cells() const { return static_cast<LocalId>(cell_to_node.size()); }
  bool is_own(Exact<LocalId> neighbor) const { return neighbor >= 0 && neighbor < n_cells(); }
  bool is_ghost(Exact<LocalId> neighbor) const { return neighbor >= n_cells(); }

  geometry::TetPoints points(Exact<LocalId> cell) const {
    const auto& n = cell_to_node[static_cast<std::size_t>(cell)];
    return {node_position[static_cast<std::size_t>(n[0])], node_position[static_cast<std::size_t>(n[1])],
            node_position[static_cast<std::size_t>(n[2])], node_position[static_cast<std::size_t>(n[3])]};
  }
  geometry::Vec3 point(Exact<LocalId> node) const { return node_position[static_cast<std::size_t>(node)]; }

  const CellField* find_cell_field(std::string_view name) const;
  CellField* find_cell_field(std::string_view name);
  const NodeField* find_node_field(std::string_view name) const;
};

/// Slot that a patch takes in `cell_to_cell`, and back.
constexpr LocalId patch_to_slot(Exact<int> patch) { return static_cast<LocalId>(-(patch + 1)); }
constexpr int slot_to_patch(Exact<LocalId> slot) { return static_cast<int>(-slot) - 1; }

/// Capacities of all arrays of the mesh, in bytes: what it takes at rest.
std::size_t bytes_at_rest(const DistMesh& mesh);

}  // namespace pamr::mesh
