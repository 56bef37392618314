// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Which triangles inside a file has beside those of the boundary.
enum class Interfaces : std::uint8_t {
  none,
  patches,     ///< faces inside that have a patch (`mesh/inner_patches.hpp`), seen from the cell with the lower number
  by_regions,  ///< and others between regions (cells with different values of the field `region`): those of each pair are
  ///< a group, seen from the region with the lower number and named `A_B` after the two (`region_N` for one
  ///< without name)
};

/// The triangles of a file.
struct TriangleGroups {
  std::vector<std::string> name;                     ///< the patches, then the interfaces, pairs of regions ascending
  std::vector<std::int64_t> number;                  ///< of the patches: `mesh::Patch::number`
  std::vector<std::array<std::int32_t, 4>> of_face;  ///< of each cell and slot: which, -1 for none
};

/// Collective: two sparse exchanges where interfaces are asked for. Cost: O(cells).
TriangleGroups group_triangles(const par::Comm& comm, const mesh::DistMesh& mesh, Interfaces interfaces);

}  // namespace pamr::io
