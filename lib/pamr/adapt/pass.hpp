// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "pamr/adapt/adapt.hpp"
#include "pamr/adapt/given_mesh.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/geometry/surface_set.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/certify.hpp"
#include "pamr/refine/closure.hpp"
#include "pamr/refine/number.hpp"
#include "pamr/refine/options.hpp"

/// One pass over a mesh: it is closed, and what the closure says is split.
namespace pamr::adapt {

/// Cells of an input mesh as they were. Their neighbors are not needed.
struct InputCells {
  GivenMesh mesh;
  bool has_all = true;
  std::vector<LocalId> cell;  ///< where it has not all of them: this rank's numbers of those that it has, ascending
};

/// A mesh that is marked and closed.
struct Closed {
  GivenMesh mesh;
  std::vector<std::uint8_t> requests;                    ///< a `refine::Request` for each cell
  mesh::MeshInfo info;                                   ///< of the mesh; flat patches that meet others have planes
  std::shared_ptr<const geometry::SurfaceSet> surfaces;  ///< that nodes are put on
  mesh::Borders borders;
  refine::Closure closure;
  Report report;  ///< of what was done so far
  /// After look-ahead splits: the input that they began with, for what has to be asked of it at the end.
  std::optional<InputCells> before;
  /// After look-ahead splits of a mesh that was lent: this rank's input cell that each cell came from, or its family's
  /// first member.
  std::vector<LocalId> input_cell;
};

/// A mesh that is not closed yet: flat patches that meet others have their planes, if the options have new nodes put
/// onto surfaces. Collective.
Closed open_pass(const par::Comm& comm, GivenMesh mesh, mesh::Borders borders, const refine::Options& options);

/// The borders of a mesh, and its closure for the requests at hand.
struct KnownClosure {
  mesh::Borders borders;
  refine::Closure closure;
};

/// A mesh that is marked.
struct Marked {
  GivenMesh mesh;
  std::vector<std::uint8_t> requests;  ///< a `refine::Request` for each cell
  std::optional<KnownClosure> known;   ///< if it was closed before
};

/// The closure has its states where nothing `has_early`. Collective.
Closed close_pass(const par::Comm& comm, Marked marked, const refine::Options& options, StepTimer& timer);

/// The refined mesh without fields, and what `transfer_pass` needs to give it its fields.
struct Split {
  mesh::DistMesh fine;
  refine::Numbering numbering;
  refine::Certificate certificate;
};

/// Frees numbers of the mesh that nothing looks at afterwards, if it is not lent. Collective.
Split split_pass(const par::Comm& comm, Closed& closed, StepTimer& timer);

/// Gives the refined mesh its fields and completes the report but for times.
Result transfer_pass(Closed closed, Split split, const refine::Options& options);

}  // namespace pamr::adapt
