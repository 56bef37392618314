// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

/// Which cells are to be split, and which may go: one value for each cell of this rank.
namespace pamr::adapt {

/// Flags from an integer cell field: 0 keep, 1 split. Collective: throws `Error` on every rank when the field is
/// missing, not an integer field of one component, or holds anything else.
std::vector<std::uint8_t> flags_from_field(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& field);

/// The same with cells that may go: -1 may go, 0 keep, 1 split.
std::vector<std::int8_t> signed_flags_from_field(const par::Comm& comm, const mesh::DistMesh& mesh,
                                                 const std::string& field);

/// Which cells are to be split, of flags with a sign: 1 for flags above 0, else 0. Local.
std::vector<std::uint8_t> splits_of(std::span<const std::int8_t> flags);

/// Throws `Error` on every rank unless each rank has one flag for each of its cells. Collective.
void require_flags(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags);

}  // namespace pamr::adapt
