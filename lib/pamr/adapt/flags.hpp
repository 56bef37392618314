// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

/// Which cells are to be split: one value for each cell of this rank, nonzero to split it.
namespace pamr::adapt {

/// Flags from an integer cell field: 0 keep, 1 split. Collective: throws `Error` on every rank when the field is
/// missing, not an integer field of one component, or holds anything else.
std::vector<std::uint8_t> flags_from_field(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& field);

/// Throws `Error` on every rank unless each rank has one flag for each of its cells. Collective.
void require_flags(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags);

}  // namespace pamr::adapt
