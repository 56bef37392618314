// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pamr/adapt/coarsening_report.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/closure.hpp"
#include "pamr/refine/options.hpp"

namespace pamr::adapt {

/// What adapting with some flags would give, exactly.
struct Forecast {
  refine::Closure closure;
  /// The mesh that the closure is of, where cells are coarsened or families have to be split before the rest; empty:
  /// that of the forecaster.
  std::shared_ptr<const mesh::DistMesh> mesh;
  refine::ClosureReport report;  ///< of all passes
  CoarseningReport coarsening;
  /// Cells that come of each of this rank's cells (at the first of a family), to 255; empty where any cell may be
  /// coarsened.
  std::vector<std::uint8_t> children;
  std::int64_t cells = 0;  ///< of the adapted mesh, all ranks
  std::int64_t cells_on_this_rank = 0;
  std::int64_t marked_too_deep = 0;  ///< flagged cells that would stay (`limit_depth`), all ranks
};

/// Tells what adapting one mesh would give, without splitting it. What does not depend on the flags is found once: make
/// one of it for many trials. The mesh has to outlive it, and may get other fields meanwhile.
class Forecaster {
 public:
  /// Collective: three sparse exchanges; for coarse walls as `with_level0_map`.
  Forecaster(const par::Comm& comm, const mesh::DistMesh& mesh, const refine::Options& options = {});

  /// `flags`: of each cell of this rank, as of `adapt`: above 0: split; below 0: may be coarsened; those of cells of
  /// the deepest level do not count. Collective. Throws `Error` on every rank for flags of the wrong length, as
  /// `require_depth` does, and for flags below 0 under another policy than `removable`. Cost: that of `refine::close`,
  /// and of a pass over the mesh each time that families have to be split before the rest; where cells may be
  /// coarsened, first that of `coarsen::take_back`, and of moving cells where siblings are on several ranks. Memory:
  /// the coarse mesh.
  Forecast forecast(std::span<const std::int8_t> flags) const;
  /// The same with nonzero for cells that are split; none may be coarsened.
  Forecast forecast(std::span<const std::uint8_t> flags) const;

  /// Nodes of the adapted mesh, all ranks. Collective. Cost: that of `refine::number`.
  std::int64_t nodes(const Forecast& forecast) const;

  /// The work of refining each cell of this rank, 1 to 255; in the unit of what one cell of the result costs. Local.
  /// Pre: no cell may be coarsened.
  std::vector<std::uint8_t> work(const Forecast& forecast) const;

 private:
  Forecast after_taking_back(std::vector<std::int8_t> signs) const;

  const par::Comm* comm_;
  std::shared_ptr<const mesh::DistMesh> ready_;  ///< a copy with a map of level 0; empty: the mesh needs none
  const mesh::DistMesh* mesh_;
  refine::Options options_;
  mesh::Borders borders_;
  std::vector<bool> is_curved_;  ///< of each patch
};

}  // namespace pamr::adapt
