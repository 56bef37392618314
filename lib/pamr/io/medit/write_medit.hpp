// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "pamr/io/interfaces.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Writes vertices, triangles of the boundary (outward) and of interfaces, and tetrahedra in Medit's format, in global
/// order: text for `.mesh`, binary for `.meshb`. References of triangles are `medit_references`, those of tetrahedra
/// the integer cell field `region` (0 without it). Text has as many digits as it takes to read the same numbers back; a
/// binary file is of the lowest version that its size allows (2; 3 beyond 2^31 bytes; 4 beyond 2^31 elements). The same
/// bytes on any number of ranks. Collective; throws the same `Error` on every rank, also for regions beyond 32 bits,
/// and leaves nothing behind then.
void write_medit(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                 Interfaces interfaces = Interfaces::patches);

/// The reference of each group of triangles (`TriangleGroups`): the user's number, N for `ref_N`, the lowest free number
/// from 1 on for the others (`patch_numbers`); -1 for the patch of faces without a tag, which are not in the file.
std::vector<std::int64_t> medit_references(const mesh::MeshInfo& info, std::vector<std::string> names,
                                           std::vector<std::int64_t> numbers);

/// Fields of a mesh for a file of Medit.
struct MeditFields {
  std::vector<const mesh::Field*> of_nodes, of_cells;
};

/// All real fields of 1, 3, 6 or 9 components where `names` is empty, else those of these names, in this order. Local.
/// Throws `Error` for names that the mesh does not have and for fields of other sizes.
MeditFields choose_medit_fields(const mesh::DistMesh& mesh, const std::vector<std::string>& names);

/// Writes these fields to a `.sol` (text) or `.solb` (binary), nodal ones before those of cells, without their names.
/// Collective; throws the same `Error` on every rank, also where there are none, or values that are not finite.
void write_medit_fields(const par::Comm& comm, const std::filesystem::path& file, const mesh::DistMesh& mesh,
                        const MeditFields& fields);

}  // namespace pamr::io
