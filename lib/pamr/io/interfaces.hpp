// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Whether a file has triangles between regions (cells with different values of the field `region`) as well as of
/// the boundary: those of each pair of regions are a group, seen from the region with the lower number and named `A_B`
/// after the two (`region_N` for one without name).
enum class Interfaces : std::uint8_t { none, by_regions };

/// The triangles of a file.
struct TriangleGroups {
  std::vector<std::string> name;                     ///< the patches, then the interfaces, pairs of regions ascending
  std::vector<std::array<std::int32_t, 4>> of_face;  ///< of each cell and slot: which, -1 for none
};

/// Collective: two sparse exchanges where interfaces are asked for. Cost: O(cells).
TriangleGroups group_triangles(const par::Comm& comm, const mesh::DistMesh& mesh, Interfaces interfaces);

}  // namespace pamr::io
