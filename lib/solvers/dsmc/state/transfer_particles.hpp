// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "pamr/mesh/dist_mesh.hpp"
#include "solvers/dsmc/flow/flow.hpp"

namespace pamr::dsmc {

/// What became of the particles of the old mesh.
struct Transferred {
  std::int64_t old_particles = 0, new_particles = 0;
  std::int64_t removed = 0;  ///< now inside a wall, or elsewhere outside the domain
  std::uint64_t step = 0;    ///< steps that the old computation had done
};

/// Fills `flow`, new and empty, with the particles of a checkpoint on the mesh that this one was refined from. The cell
/// field `parent` names for every cell the old cell that contains its centroid.
///
/// - Place: each particle starts from the center of a cell whose parent it was in and moves on a straight line to its
///   place through the neighbors of the new mesh, because projected and smoothed nodes make the meshes not nested. A
///   particle that meets the boundary on the way is now outside and is removed.
/// - Number: a particle becomes (old F_num / new F_num) particles on average, rounded at random. The random numbers
///   belong to the old particle, so the result does not depend on the number of ranks. Particles are numbered anew.
/// - Cells inherit (sigma c_r)_max and, by volume, the energy deficit of the old cell (see `Collider`).
///
/// Collective. Throws the same `Error` on every rank when the mesh has no field `parent`, when the old cells are not
/// those that the field names (by their number, and by the volumes of the cells with the same parent), or for other
/// species.
Transferred transfer_particles(const par::Comm& comm, const std::string& file, const mesh::DistMesh& mesh, Flow& flow);

}  // namespace pamr::dsmc
