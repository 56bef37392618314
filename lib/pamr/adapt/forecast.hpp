// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/closure.hpp"
#include "pamr/refine/options.hpp"

namespace pamr::adapt {

/// What refining with some flags would give, exactly.
struct Forecast {
  refine::Closure closure;
  /// The mesh that the closure is of, where early families have to be split first; empty: that of the forecaster.
  std::shared_ptr<const mesh::DistMesh> mesh;
  refine::ClosureReport report;  ///< of all passes
  std::vector<std::uint8_t>
      children;            ///< cells that come of each of this rank's cells (at the first of a family), to 255
  std::int64_t cells = 0;  ///< of the refined mesh, all ranks
  std::int64_t cells_on_this_rank = 0;
  std::int64_t marked_too_deep = 0;  ///< flagged cells that would stay (`limit_depth`), all ranks
};

/// Tells what refinements of one mesh would give, without splitting anything. What does not depend on the flags is
/// found once: make one of it for many trials. The mesh has to outlive it.
class Forecaster {
 public:
  /// Collective: three sparse exchanges.
  Forecaster(const par::Comm& comm, const mesh::DistMesh& mesh, const refine::Options& options = {});

  /// `flags`: of each cell of this rank, nonzero: split; those of cells of the deepest level do not count. Collective.
  /// Throws `Error` on every rank for flags of the wrong length, and as `require_depth` does. Cost: that of
  /// `refine::close`, and of a pass over the mesh each time that families have to be split before the rest.
  Forecast forecast(std::span<const std::uint8_t> flags) const;

  /// Nodes of the refined mesh, all ranks. Collective. Cost: that of `refine::number`.
  std::int64_t nodes(const Forecast& forecast) const;

  /// The work of refining each cell of this rank, 1 to 255; in the unit of what one cell of the result costs. Local.
  std::vector<std::uint8_t> work(const Forecast& forecast) const;

 private:
  const par::Comm* comm_;
  const mesh::DistMesh* mesh_;
  refine::Options options_;
  mesh::Borders borders_;
  std::vector<bool> is_curved_;  ///< of each patch
};

}  // namespace pamr::adapt
