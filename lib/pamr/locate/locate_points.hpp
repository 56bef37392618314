// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "pamr/locate/locator.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::locate {

/// Where points lie.
struct PointLocations {
  std::vector<GlobalId> cell;  ///< global number of the cell that holds the point; `invalid_global`: none does
  std::vector<Rank> rank;      ///< that holds the cell; -1: none
};

/// For each point of this rank the cell of any rank that holds it, inside or on its surface, by exact predicates; of
/// several the one with the smallest global number. The same on any number of ranks.
/// - `locator`: of this rank's part of the mesh, to be made once for many calls.
/// - `near`: none, or for each point a cell of this rank to begin at (`invalid_local`: none): see `Locator::find`.
///
/// Collective: a gather of six numbers a rank, and one sparse exchange each of the points that are not strictly inside
/// a cell of their own rank and of the answers. Throws `Error` on every rank for lists of different lengths.
PointLocations locate_points(const par::Comm& comm, const mesh::DistMesh& mesh, const Locator& locator,
                             std::span<const geometry::Vec3> points, std::span<const LocalId> near = {});

}  // namespace pamr::locate
