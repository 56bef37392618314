// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/refine/split_pattern.hpp"

/// The values that flow from `close` to the steps after it.
namespace pamr::refine {

/// What becomes of an old cell.
enum class Action : std::uint8_t {
  split,     ///< its own pattern, given by its marks (no marks: it stays as it is)
  rebuild,   ///< first member of a closure family that is taken back to its parent
  absorbed,  ///< another member of such a family
};

/// A closure family that is taken back: its parent is split by `state`, and each of the children once more by its
/// marks.
struct RebuiltFamily {
  LocalId first = invalid_local;  ///< first member
  int state = 0;                  ///< how the parent is split now
  int n_children = 0;             ///< cells that it becomes, second generation included
  bool is_safe = false;           ///< straight and so far from flat that rounding turns no child over
  std::array<EdgeMask, max_children> child_marks{};
};

/// What closing a mesh took; counts over all ranks.
struct ClosureReport {
  std::int64_t n_marked = 0;          ///< cells that were flagged
  std::int64_t families_rebuilt = 0;  ///< closure families taken back to their parent
  std::int64_t families_kept = 0;     ///< those with marks whose parent cannot be rebuilt
  int rounds = 0;                     ///< exchanges with the neighbors
};

/// Legal marks in every cell: the edges that get a new node.
struct Closure {
  std::vector<EdgeMask> marks;         ///< n_cells: bits of the cell's edges
  std::vector<Action> action;          ///< n_cells
  std::vector<RebuiltFamily> rebuilt;  ///< ascending in `first`
  bool halves_are_paired = false;      ///< of the refined mesh, see `mesh::MeshInfo`
  ClosureReport report;
};

/// The number of cells that each old cell becomes; those of a family that is taken back are all counted at its first
/// member. `n_cells` values. Local.
std::vector<std::uint8_t> count_children(const Closure& closure);

/// This rank's flagged cells of which the refined mesh holds a part that was not split into eight. Local.
std::int64_t count_not_split(const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags, const Closure& closure);

}  // namespace pamr::refine
