// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/flow/flow.hpp"
#include "solvers/dsmc/state/run_state.hpp"
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

/// Whether a checkpoint with this header is one of a flow on this mesh. Local; throws `Error` where the header is
/// damaged.
bool is_of_mesh(const nlohmann::json& header, const MeshKey& mesh);

/// Everything that a computation needs to go on, in tables that do not depend on ranks and partition: particles in the
/// order of their global cells and ids, collisions and averages of the cells, sums on the walls, history.
struct Snapshot {
  nlohmann::json header;
  Section cells, faces, particles;
};

/// Collective. Memory: a copy of particles and cells.
Snapshot take_snapshot(const par::Comm& comm, const MeshKey& mesh, const RunState& run, const Flow& flow);

/// Puts a snapshot back into `flow`, which is new and made from the same case, on any number of ranks and with any
/// partition of the same mesh. Returns the state of the run. Collective. Throws the same `Error` on every rank when the
/// tables do not fit together.
RunState restore(const par::Comm& comm, const Snapshot& snapshot, Flow& flow);

/// Throws `Error` for a checkpoint of another mesh or order of cells. Local; the same on every rank.
void require_same_mesh(const SectionFile& file, const MeshKey& mesh);

/// Key of a header, of a run that adapts its mesh: fingerprint of the mesh that it began with.
inline constexpr const char* begun_on_member = "begun_on";
/// Nothing for a header without it: of a run whose mesh stays, or of an older version. Local; throws `Error`.
std::optional<std::uint64_t> begun_on(const nlohmann::json& header);

/// What a checkpoint says of the run that goes on from it.
struct CheckpointHead {
  std::uint64_t steps_done = 0;
  std::string mesh_file;  ///< of a run that adapts its mesh: the mesh as it was then; else empty
  std::optional<std::uint64_t> begun_on = {};
  double fnum = 0;  ///< molecules that a particle stands for where the time step is the largest
  std::int64_t n_particles = 0;
};
/// Collective. Throws the same `Error` on every rank for a damaged file.
CheckpointHead head_of(const par::Comm& comm, const std::string& checkpoint);

/// Its mesh file, if the file is a checkpoint that has one. Local.
std::vector<std::string> files_in_checkpoint(const std::string& file);

/// Writes a snapshot as a file: the same bytes on any number of ranks. Collective; throws `Error`.
void write_checkpoint(const par::Comm& comm, const std::string& file, const Snapshot& snapshot);
/// Reads it back; `gas` of the case. Collective. Throws the same `Error` on every rank for a damaged file.
Snapshot read_checkpoint(const SectionFile& file, const Gas& gas);

}  // namespace pamr::dsmc
