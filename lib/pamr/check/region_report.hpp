// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::check {

/// Facts about the cells of one region.
struct RegionReport {
  std::int64_t number = 0;  ///< value of the cell field `region`
  std::string name;         ///< that it is known by; its number where it has none of its own
  std::int64_t cells = 0;
  double volume = 0;          ///< sum of the cells' signed volumes, cubic length unit
  double min_mean_ratio = 0;  ///< of its cells
};

/// The regions that cells are in, ascending by number; none without the field `region`, or where it has more than 1,000
/// different values, which then are no regions. The same for every number of ranks, to the last bit.
/// Collective: two small gatherings, three reductions. O(cells).
std::vector<RegionReport> measure_regions(const par::Comm& comm, const mesh::DistMesh& mesh);

}  // namespace pamr::check
