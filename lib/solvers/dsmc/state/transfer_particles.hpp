// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "solvers/dsmc/flow/flow.hpp"
#include "solvers/dsmc/state/hosts.hpp"
#include "solvers/dsmc/state/section_file.hpp"

namespace pamr::dsmc {

/// What became of the particles of the old mesh.
struct Transferred {
  std::int64_t old_particles = 0, new_particles = 0;
  std::int64_t removed = 0;  ///< now inside a wall, or elsewhere outside the domain
  std::uint64_t step = 0;    ///< steps that the old computation had done
};

/// The flow on a mesh that was adapted since: tables as in a checkpoint.
struct OldFlow {
  std::string name;  ///< for messages
  Section cells, particles;
  std::vector<double> weights;  ///< of the species
  bool is_weighted = false;
  std::uint64_t steps_done = 0;
  bool is_vibrating = false;
  std::vector<Vibration> vibration = {};  ///< of the species, if it vibrates
};

/// Fills `flow`, new and empty, with the particles of a flow on the mesh that this one was adapted from. The cell
/// field `parent` names for every cell the old cell that contains its centroid.
///
/// - Place: each particle starts from the center of a cell whose parent it was in and moves on a straight line to its
///   place through the neighbors of the new mesh, because projected and smoothed nodes make the meshes not nested. A
///   particle that meets the boundary on the way is looked for in all cells; if none holds it, it is outside now and is
///   removed.
/// - Number: a particle becomes (old F_num / new F_num) particles on average, rounded at random. The random numbers
///   belong to the old particle, so the result does not depend on the number of ranks. The particle keeps its id and
///   its last collision partner, further copies of it get new ids.
/// - Vibration: where only the new flow vibrates, the levels are those of its free stream.
/// - A cell that has not changed keeps all that it remembers of its collisions. Other cells inherit from the old cell
///   (sigma c_r)_max, temperature and, by volume, the energy deficit (see `Collider`), and draw a new remainder, which
///   keeps the number of candidates right on average. An old cell that is nobody's parent leaves its (sigma c_r)_max
///   and deficit to the cell that has its place.
///
/// `gone`: the old cells that were coarsened away; any rank may name any of them.
/// Collective. Throws the same `Error` on every rank for more particles than memory holds.
Transferred transfer_particles(const par::Comm& comm, const OldFlow& old, std::span<const GoneCell> gone,
                               const mesh::DistMesh& mesh, Flow& flow);

/// The same on the mesh that the flow is on: `parent` is not read. Collective.
Transferred transfer_particles(const par::Comm& comm, const OldFlow& old, const mesh::DistMesh& mesh, Flow& flow);

/// The same from a checkpoint on the mesh that this one was refined from, or on this mesh: then the field `parent` is
/// not needed, and not read. Collective. Throws the same `Error` on every rank when the mesh has no field `parent`,
/// when the old cells are not those that the field names (by their number, and by the volumes of the cells with the
/// same parent), or for other species.
Transferred transfer_particles(const par::Comm& comm, const std::string& file, const mesh::DistMesh& mesh, Flow& flow);

}  // namespace pamr::dsmc
