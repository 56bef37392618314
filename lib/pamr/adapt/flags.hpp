// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/refine/options.hpp"

/// Which cells are to be split, and which may be coarsened: one value for each cell of this rank.
namespace pamr::adapt {

/// Flags from an integer cell field: 0 keep, 1 split. Collective: throws `Error` on every rank when the field is
/// missing, not an integer field of one component, or holds anything else.
std::vector<std::uint8_t> flags_from_field(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& field);

/// The same with coarsening: -1 may be coarsened, 0 keep, 1 split.
std::vector<std::int8_t> signed_flags_from_field(const par::Comm& comm, const mesh::DistMesh& mesh,
                                                 const std::string& field);

/// Which cells are to be split, of flags with a sign: 1 for flags above 0, else 0. Local.
std::vector<std::uint8_t> splits_of(std::span<const std::int8_t> flags);

/// Flags with a sign: 1 for the marked cells, -1 for others that may be coarsened. Local.
std::vector<std::int8_t> signed_flags(std::span<const std::uint8_t> marks, std::span<const std::uint8_t> may_go);
/// 1 for the marked cells; no cell may be coarsened. Local.
std::vector<std::int8_t> signed_flags(std::span<const std::uint8_t> marks);

/// Whether a flag of this rank has this sign (1 or -1). Local.
bool has_sign(std::span<const std::int8_t> flags, int sign);

/// The flags as -1, 0 and 1. Throws `Error` on every rank unless each rank has one flag for each of its cells and the
/// options can be obeyed with them: flags below 0 need the policy `removable`. Collective.
std::vector<std::int8_t> checked_signs(const par::Comm& comm, const mesh::DistMesh& mesh,
                                       std::span<const std::int8_t> flags, const refine::Options& options);

}  // namespace pamr::adapt
