// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <set>
#include <vector>

#include "pamr/geometry/vec3.hpp"
#include "support/reference_family.hpp"

/// Cells by where they are: the same in meshes that number their nodes differently.
namespace pamr::test {

struct BeforeInSpace {
  bool operator()(const geometry::Vec3& a, const geometry::Vec3& b) const {
    return geometry::lexicographically_less(a, b);
  }
};

/// The corners of a cell.
using Place = std::set<geometry::Vec3, BeforeInSpace>;

struct BeforeByCorners {
  bool operator()(const Place& a, const Place& b) const {
    return std::lexicographical_compare(a.begin(), a.end(), b.begin(), b.end(), BeforeInSpace());
  }
};
using Places = std::set<Place, BeforeByCorners>;

/// The base cell of each cell of a whole mesh.
inline std::vector<Place> places_of_base_cells(const mesh::BlockMesh& whole) {
  std::vector<Place> places;
  for (const auto& corners : base_cells_of(pieces_of(whole))) {
    places.emplace_back();
    for (const auto node : corners) places.back().insert(whole.node_position[static_cast<std::size_t>(node)]);
  }
  return places;
}

}  // namespace pamr::test
