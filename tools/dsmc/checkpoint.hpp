// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>

#include "dsmc/run.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::dsmc {

/// What tells whether a checkpoint belongs to a mesh: its fingerprint, and a hash of the numbers of its cells.
struct MeshKey {
  std::uint64_t fingerprint = 0;
  std::uint64_t numbering = 0;
  GlobalId n_cells = 0;
};
/// Collective.
MeshKey key_of(const par::Comm& comm, const mesh::DistMesh& mesh);

/// Writes everything that the computation needs to go on: particles, collisions and averages of the cells, sums on the
/// walls, history. Particles lie in the order of their global cells and ids, so the file has the same bytes on any
/// number of ranks. Collective; throws `Error`. Memory: twice the particles for a while.
void write_checkpoint(const par::Comm& comm, const std::string& file, const MeshKey& mesh, const Run& run,
                      const Flow& flow);

/// Takes a computation up where it was written, on any number of ranks and with any partition of the same mesh. `run`
/// and `flow` are new and made from the same case. Collective. Throws the same `Error` on every rank for a damaged
/// file, another mesh, other species, time step or weight.
void read_checkpoint(const par::Comm& comm, const std::string& file, const MeshKey& mesh, Run& run, Flow& flow);

}  // namespace pamr::dsmc
