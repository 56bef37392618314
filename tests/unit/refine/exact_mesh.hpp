// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "pamr/assemble/assemble.hpp"

/// Geometry without rounding, for meshes whose coordinates are whole multiples of 2^-30 and at most 8 in size: volumes
/// and areas are whole numbers.
namespace pamr::test {

__extension__ using Wide = __int128;
using WholePoint = std::array<std::int64_t, 3>;
using WholeVector = std::array<Wide, 3>;

/// Coordinates times 2^30. Throws `std::logic_error` where one is not whole.
std::vector<WholePoint> to_whole(const std::vector<geometry::Vec3>& point);

/// Six times the volume, times 2^90.
Wide six_volumes(const std::vector<WholePoint>& point, const std::array<GlobalId, 4>& cell);

/// A face of the boundary: its corners and its patch.
struct BoundaryFace {
  std::array<GlobalId, 3> corner{};
  int patch = 0;
};
/// In order of cells and slots, corners ordered so that the normal points outwards.
std::vector<BoundaryFace> boundary_of(const mesh::BlockMesh& whole);

/// Twice the area vector, times 2^60.
WholeVector area_vector(const std::vector<WholePoint>& point, const std::array<GlobalId, 3>& corner);

/// True when all three points of a triangle lie in another one, its border included.
bool lies_in(const std::array<WholePoint, 3>& inner, const std::array<WholePoint, 3>& outer);

}  // namespace pamr::test
