// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/refine/movable.hpp"
#include "pamr/refine/new_level.hpp"
#include "pamr/refine/project.hpp"
#include "pamr/refine/subdivide.hpp"

namespace pamr::refine {

/// Where the nodes of the refined mesh may go.
struct Freedom {
  static constexpr std::int32_t fixed = -2, inner = -1;

  /// Per node of the refined mesh: `fixed` (old nodes, held ones, nodes of patches without surface, on seams and on
  /// sharp edges inside a surface), `inner` (anywhere), or the row of `on` with the surfaces that the node stays on.
  std::vector<std::int32_t> of_node;
  std::vector<SurfacesOfNode> on;
};

/// New nodes are free: inside, or along the surfaces of their patches. So are the old ones of the movement, which were
/// off their surfaces.
Freedom free_nodes(const NewLevel& level, const Movement& movement);

/// Rows of a table in which each node finds the things it belongs to.
struct RowsOfNode {
  std::vector<std::size_t> begin{0};
  std::vector<LocalId> item;

  std::span<const LocalId> at(std::size_t i) const { return {item.data() + begin[i], item.data() + begin[i + 1]}; }
};

/// The nodes that may move near the cells that need it, all cells at them, and all closure families at them, numbered
/// among themselves.
struct UntangleRegion {
  std::vector<LocalId> node;                    ///< local ids in the refined mesh
  std::vector<std::uint8_t> may_move;           ///< per entry of `node`
  std::vector<mesh::CellNodes> cell;            ///< corners as entries of `node`
  std::vector<std::array<LocalId, 10>> family;  ///< the parent's nodes by code as entries of `node`, -1: not there
  RowsOfNode cells_of_node, families_of_node;   ///< entries of `cell` and of `family`
  par::Pattern shared;                          ///< entries of `node` that may move and other ranks hold too
  bool reaches_open = false;                    ///< it would go on beyond the level's open nodes
};

/// First cells of the closure families of the given cells, which ascend.
std::vector<LocalId> families_of(const Children& children, const std::vector<LocalId>& cells);

/// Nodes of the parent of a closure family of the refined mesh, by code; -1: not there.
std::array<LocalId, 10> parent_nodes(const Children& children, LocalId first);

/// The region within `n_layers` cells of the given cells, over all ranks. Collective: one exchange a layer.
UntangleRegion gather_region(const par::Comm& comm, const NewLevel& level, const Freedom& freedom,
                             const std::vector<LocalId>& cells, int n_layers);

}  // namespace pamr::refine
