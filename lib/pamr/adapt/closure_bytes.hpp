// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/refine/closure.hpp"

/// What lets a closed mesh change ranks before it is split.
namespace pamr::adapt {

/// The closure as one byte a cell: its marks and its action. Local.
std::vector<std::uint8_t> closure_to_bytes(const refine::Closure& closure);

/// The closure of the cells that a rank has now, from the bytes that came along with them; the plans of the families
/// that are taken back and the states of the others follow from the mesh and the marks. The report is passed on. Local.
refine::Closure closure_from_bytes(const mesh::DistMesh& mesh, std::span<const std::uint8_t> bytes,
                                   const refine::Options& options, const refine::ClosureReport& report);

}  // namespace pamr::adapt
