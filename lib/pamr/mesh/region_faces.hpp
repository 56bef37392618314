// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {

/// The field with the region of each cell: `region_field` where it has integers and one component, else none. Local.
const CellField* find_regions(const DistMesh& mesh);

/// A face between two regions, from the cell in the one with the lower number.
struct RegionFace {
  CellFace face;
  std::array<std::int64_t, 2> region{};  ///< ascending
};

/// The faces between cells with different values of `region_field`, by cell and slot: each face once, on the rank of
/// the cell with the lower value. Empty without an integer field of that name and one component.
/// Collective: one message to each neighbor. Cost: O(cells).
std::vector<RegionFace> faces_between_regions(const par::Comm& comm, const DistMesh& mesh);

/// The name of a region, or an empty text.
std::string name_of_region(const MeshInfo& info, Exact<std::int64_t> number);

}  // namespace pamr::mesh
