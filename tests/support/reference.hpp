// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <map>
#include <set>
#include <vector>

#include "pamr/assemble/assemble.hpp"

/// Slow, obvious twins of the library's kernels. They take a whole mesh in one block and are serial.
namespace pamr::test {

/// Neighbors by a map from faces to cells; a face with one cell gets -1 (patch 0).
std::vector<std::array<GlobalId, 4>> reference_neighbors(const std::vector<std::array<GlobalId, 4>>& cell_to_node);

/// Cells at each edge, edges by ascending node numbers.
std::map<std::array<GlobalId, 2>, std::set<GlobalId>> reference_edge_to_cell(
    const std::vector<std::array<GlobalId, 4>>& cell_to_node);

/// Sum of the cells' signed volumes.
double reference_volume(const mesh::BlockMesh& whole);

/// Area of each patch.
std::vector<double> reference_patch_areas(const mesh::BlockMesh& whole);

/// The fingerprint by its formula, written out again from its specification.
std::uint64_t reference_fingerprint(const mesh::BlockMesh& whole);

}  // namespace pamr::test
