// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "pamr/mesh/dist_mesh.hpp"
#include "solvers/dsmc/kernel/flow.hpp"

namespace pamr::dsmc {

/// What became of the particles of the old mesh.
struct Carried {
  std::int64_t old_particles = 0, new_particles = 0;
  std::int64_t removed = 0;  ///< now inside a wall, or outside the domain otherwise
  std::uint64_t step = 0;    ///< at which the old computation stood
};

/// Fills `flow`, new and empty, with the particles of a checkpoint on the mesh that this one was refined from. The cell
/// field `parent` names for every cell the old cell that holds its centroid. Each particle starts from the middle of a
/// cell whose parent it was in and walks straight to its place through the neighbors of the new mesh, because
/// projected and smoothed nodes make the meshes not nested; what meets the boundary on the way lies outside now and is
/// removed. A particle becomes old over new weight particles on average, whole ones at random; the numbers drawn belong
/// to the old particle, so the result does not depend on the number of ranks. Cells inherit the bound of their
/// collisions, and by their volumes what energy the old cell owes (see `Collider`). Particles are numbered anew.
/// Collective. Throws the same `Error` on every rank when the mesh has no field `parent`, or when the old cells are not
/// those that the field names (their number, and the volumes of the cells with the same parent), or for other species.
Carried carry(const par::Comm& comm, const std::string& file, const mesh::DistMesh& mesh, Flow& flow);

}  // namespace pamr::dsmc
