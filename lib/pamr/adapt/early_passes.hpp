// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pamr/adapt/pass.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/options.hpp"

/// Families that have to be split before the rest of the mesh is (docs/refinement.md).
namespace pamr::adapt {

/// Cells of an input mesh as they were: this rank's of these numbers, ascending. Their neighbors are not needed.
struct InputCells {
  mesh::DistMesh mesh;
  std::vector<LocalId> cell;
};

/// A mesh, what is asked of its cells, and its closure.
struct Ready {
  std::optional<mesh::DistMesh> mesh;  ///< empty: the input mesh
  std::vector<std::uint8_t> requests;
  /// This rank's input cell that each cell came from, or its family's first member; empty without a mesh, and
  /// where the input was taken over.
  std::vector<LocalId> input_cell;
  Closed closed;
  /// The input's cells that early passes worked on; empty: ask the input itself.
  std::optional<InputCells> members;
};

/// Splits early families, pass by pass, until there are none: the closure then has its states, and its depth is
/// checked. Without early families nothing changes. The new mesh knows the input cells by `cell_origin`, see
/// `origins_of_pass`.
///
/// The passes work on the cells near the families, a part of the mesh that grows where something would reach its end,
/// and which is put back once, after the last. The rare passes that may reach anywhere have the whole mesh: those that
/// meet nodes off their surfaces or families that have to be kept.
/// `own`: the input, if it may be changed: where the result has `members`, it was taken over.
/// Collective. Cost: what the part costs in each pass, and one pass over the arrays of the mesh; without `own` a copy.
Ready split_all_early(const par::Comm& comm, const mesh::DistMesh& input, Ready ready, const refine::Options& options,
                      StepTimer& timer, mesh::DistMesh* own = nullptr);

}  // namespace pamr::adapt
