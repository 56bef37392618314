// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pamr/adapt/coarsening_report.hpp"
#include "pamr/adapt/given_mesh.hpp"
#include "pamr/adapt/pass.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/coarsen/coarse_fields.hpp"
#include "pamr/coarsen/coarsen.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/options.hpp"

/// The first step where cells may be coarsened: octets that nothing needs are coarsened.
namespace pamr::adapt {

/// A mesh that was coarsened, and what is to be split of it.
struct TakenBack {
  GivenMesh mesh;
  std::vector<std::uint8_t> flags;      ///< of its cells: 1 to split
  std::optional<KnownClosure> closure;  ///< of the mesh with its flags, if it is known; on all ranks alike
  bool is_coarser = false;              ///< false: nothing is coarsened, on any rank
  CoarseningReport report;
  std::vector<coarsen::Merged> merged;  ///< see `Result`
};

/// The mesh coarsened where flags allow it and nothing needs the cells, with its fields and `cell_origin`; where no
/// flag is below 0 the mesh itself. Checks flags and options as `adapt` says. Collective.
TakenBack take_back(const par::Comm& comm, GivenMesh mesh, std::span<const std::int8_t> flags,
                    const refine::Options& options, StepTimer& timer);

/// Where cells have to go so that all siblings that may be coarsened are on one rank; empty on every rank if they are
/// already.
struct Gathering {
  std::vector<Rank> destination;
  std::int64_t cells_moved = 0;  ///< all ranks
};

/// `signs`: of each cell, -1, 0 or 1. Collective.
Gathering find_gathering(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int8_t> signs);

/// The mesh with its siblings together, and its flags. Collective. Cost: that of `balance::migrate`.
mesh::DistMesh gather(const par::Comm& comm, mesh::DistMesh mesh, const Gathering& where,
                      std::vector<std::int8_t>& signs);

/// What is left of a mesh, without fields.
struct CoarseMesh {
  coarsen::Settled settled;
  std::optional<coarsen::Coarsened> made;  ///< none where nothing is coarsened, on any rank
  std::optional<KnownClosure> closure;     ///< of the coarse mesh with its flags, if anything is to be split
  CoarseningReport report;                 ///< but for `cells_moved`
};

/// A mesh with a flag for each cell, -1, 0 or 1. Only references.
struct FlaggedMesh {
  const mesh::DistMesh& mesh;
  const mesh::Borders& borders;
  std::span<const std::int8_t> signs;
};

/// Coarsens what neither the closure of the remaining splits nor refining needs. What refining needs shows when the
/// coarse mesh is closed: nodes of the old mesh that are marked there stay, and it is settled again with them, until
/// there is none. Each of them is needed by what remains for certain, so the result is the same as if all had been
/// settled at once. Pre: siblings are together. Collective. Cost: that of `coarsen::take_back` and `refine::close`, as
/// often as nodes turn out to be needed.
CoarseMesh make_coarse_mesh(const par::Comm& comm, const FlaggedMesh& flagged, const refine::Options& options,
                            StepTimer& timer);

/// Gives the coarse mesh the fields of the old one, as the options say. Collective, see `coarsen::carry_fields`.
void carry_fields(const par::Comm& comm, const mesh::DistMesh& old, const refine::Options& options, CoarseMesh& coarse);

}  // namespace pamr::adapt
