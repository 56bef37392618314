// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "mesh/raw_mesh.hpp"

namespace pamr::meshing {

/// Place of a point of the grid of 2^21 cubes a side along Hilbert's curve: 63 bits. Source: J. Skilling, "Programming
/// the Hilbert curve", AIP Conf. Proc. 707 (2004).
std::uint64_t hilbert_key(std::array<std::uint32_t, 3> grid_point);

/// The same mesh with its cells along Hilbert's curve by centroid and its nodes in the order in which the cells name
/// them, so that neighbours in space are neighbours in the file and in a block of it. Local, deterministic.
RawMesh ordered(const RawMesh& mesh);

}  // namespace pamr::meshing
