// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/refine/options.hpp"
#include "pamr/refine/split_pattern.hpp"

/// The values that flow from `close` to the steps after it.
namespace pamr::refine {

/// What becomes of an old cell.
enum class Action : std::uint8_t {
  split,     ///< its own pattern, given by its marks (no marks: it stays as it is)
  rebuild,   ///< first member of a closure family that is taken back to its parent
  absorbed,  ///< another member of such a family
};

/// A closure family that is taken back: its parent is split by `state`, and each of the children once more.
struct RebuiltFamily {
  LocalId first = invalid_local;  ///< first member
  SplitState state = 0;           ///< how the parent is split now
  std::uint8_t n_children = 0;    ///< cells that it becomes, second generation included
  bool is_safe = false;           ///< straight and so far from flat that rounding inverts no child
  bool is_early = false;          ///< has to be split before the others: the marks of a child are not all yet
  std::array<SplitState, max_children> child_state{};
};

/// What closing a mesh took; counts over all ranks.
struct ClosureReport {
  std::int64_t n_marked = 0;          ///< cells that were flagged
  std::int64_t families_rebuilt = 0;  ///< closure families taken back to their parent
  std::int64_t families_kept = 0;     ///< those with marks whose parent cannot be rebuilt
  int rounds = 0;                     ///< exchanges with the neighbors
  int sweeps = 0;                     ///< over the cells that marks have reached, of the rank with the most
  int early_passes = 0;               ///< splits that had to go before, each a pass over the mesh
};

/// Legal marks in every cell: the edges that get a new node.
struct Closure {
  std::vector<EdgeMask> marks;  ///< n_cells: bits of the cell's edges
  std::vector<Action> action;   ///< n_cells
  std::vector<SplitState>
      state;  ///< n_cells, see `find_states`: of those with action `split`; of 1:8 that of diagonal 0
  std::vector<RebuiltFamily> rebuilt;  ///< ascending in `first`
  bool has_early = false;              ///< some rank has families that are to be split before the others
  bool cut_faces_conform = false;      ///< of the refined mesh, see `mesh::MeshInfo`
  ClosureReport report;
};

/// Fills `action`, which follows from the marks and the rebuilt families. Local.
void decide_actions(const mesh::DistMesh& mesh, Closure& closure);

/// The number of cells that each old cell becomes; those of a family that is taken back are all counted at its first
/// member. `n_cells` values. Local.
std::vector<std::uint8_t> count_children(const Closure& closure);

/// Fills `state`, which follows from the marks and actions and the positions of the nodes. Local.
void find_states(const mesh::DistMesh& mesh, const Options& options, Closure& closure);

/// This rank's cells with a request to split them of which the refined mesh holds a part that was not split into eight.
/// Local.
std::int64_t count_not_split(const mesh::DistMesh& mesh, std::span<const std::uint8_t> requests,
                             const Closure& closure);

}  // namespace pamr::refine
