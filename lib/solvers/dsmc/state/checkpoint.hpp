// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/run/run.hpp"
#include "solvers/dsmc/state/section_file.hpp"

namespace pamr::dsmc {

/// What tells whether a checkpoint belongs to a mesh: its fingerprint, and a hash of the order of its cells.
struct MeshKey {
  std::uint64_t fingerprint = 0;
  std::uint64_t numbering = 0;
  GlobalId n_cells = 0;
};
/// Collective.
MeshKey key_of(const par::Comm& comm, const mesh::DistMesh& mesh);

/// Everything that a computation needs to go on, in tables that no longer depend on ranks and partition: particles in
/// the order of their global cells and ids, collisions and averages of the cells, sums on the walls, history.
struct Snapshot {
  nlohmann::json header;
  Section cells, faces, particles;
};

/// Collective. Memory: twice the particles for a while.
Snapshot take_snapshot(const par::Comm& comm, const MeshKey& mesh, const Run& run, const Flow& flow);

/// Takes a computation up where it was, on any number of ranks and with any partition of the same mesh. `run` and
/// `flow` are new and made from the same case. Collective. Throws the same `Error` on every rank for another mesh,
/// species, time step or weight; `name` is the file's.
void restore(const par::Comm& comm, const Snapshot& snapshot, const std::string& name, const MeshKey& mesh, Run& run,
             Flow& flow);

/// A snapshot as a file: the same bytes on any number of ranks. Collective; throws `Error`.
void write_checkpoint(const par::Comm& comm, const std::string& file, const Snapshot& snapshot);
/// Collective. Throws the same `Error` on every rank for a damaged file. `gas` of the case.
Snapshot read_checkpoint(const par::Comm& comm, const std::string& file, const Gas& gas);

}  // namespace pamr::dsmc
