// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pamr/adapt/adapt.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/geometry/surface_set.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/carried.hpp"
#include "pamr/refine/certify.hpp"
#include "pamr/refine/closure.hpp"
#include "pamr/refine/number.hpp"
#include "pamr/refine/options.hpp"

/// One pass over a mesh: it is closed, and what the closure says is split.
namespace pamr::adapt {

/// A mesh that is marked and closed.
struct Closed {
  mesh::MeshInfo info;                                   ///< of the mesh; flat patches that meet others have planes
  std::shared_ptr<const geometry::SurfaceSet> surfaces;  ///< that nodes are put on
  mesh::Borders borders;
  refine::Closure closure;
  Report report;  ///< of what was done so far
};

/// A pass over a mesh that is not closed yet: flat patches that meet others have their planes, if the options have new
/// nodes put onto surfaces. Collective.
Closed open_pass(const par::Comm& comm, const mesh::DistMesh& mesh, mesh::Borders borders,
                 const refine::Options& options);

/// `requests`: a `refine::Request` for each cell. The closure has its states where nothing `has_early`. Collective.
Closed close_pass(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::uint8_t> requests,
                  const refine::Carried& carried, const refine::Options& options, StepTimer& timer);

/// The refined mesh without fields, and what `transfer_pass` needs to give it its fields.
struct Split {
  mesh::DistMesh fine;
  refine::Numbering numbering;
  refine::Certificate certificate;
};

Split split_pass(const par::Comm& comm, const mesh::DistMesh& mesh, const Closed& closed, StepTimer& timer);

/// Gives the refined mesh its fields and completes the report but for times.
RefineResult transfer_pass(const mesh::DistMesh& mesh, Closed closed, Split&& split, const refine::Options& options);

/// A mesh on its way through early passes, and what is still asked of its cells.
struct Unfinished {
  mesh::DistMesh mesh;
  std::vector<std::uint8_t> requests;
  refine::Carried carried;
  std::vector<LocalId> input_cell;  ///< this rank's input cell that each cell came from, or its family's first member
};

/// The splits that have to go before: those of the early families of `closed`. The cells stay on their ranks.
/// `input_cell`: this rank's input cell of each cell of `mesh`; empty: `mesh` is the input. The new mesh knows the
/// input cells by `cell_origin`, see `origins_of_pass`. Adds to the report of `closed`.
///
/// Nothing if a family would have to be kept and broken for it: then `closed` has no early families any more, but its
/// states, and children are closed as they are, under the floor or not. So each early pass splits all its early
/// families, and there is an end to them. Collective.
std::optional<Unfinished> split_early(const par::Comm& comm, const mesh::DistMesh& mesh,
                                      std::span<const std::uint8_t> requests, std::span<const LocalId> input_cell,
                                      Closed& closed, const refine::Options& options, StepTimer& timer);

/// Adds what one pass did to what is known of those before it.
void add_to_report(const Report& pass, Report& sum);

}  // namespace pamr::adapt
