// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::check {

/// Chooses the `count` cells of lowest mean ratio, all of them when there are fewer: `result[c]` is 1 for a chosen
/// cell. Ties are broken by the centroid's coordinates, so the choice does not depend on numbering or ranks.
/// Collective: at most 41 reductions.
std::vector<std::uint8_t> worst_cells(const par::Comm& comm, const mesh::DistMesh& mesh, Exact<std::int64_t> count);

/// A mesh of the chosen cells alone, in their old order: the faces laid bare form the one patch `cut`, all cells are
/// regular. Cell fields: `cell` (old global number), `level`, and each of `metric_names`. `chosen` has one entry a
/// cell. The result is the same for every number of ranks up to its distribution.
/// Collective; cost as an assembly of the chosen cells, plus 2 bytes of traffic for each cell and node.
mesh::DistMesh extract_cells(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::uint8_t> chosen);

}  // namespace pamr::check
