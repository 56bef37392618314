// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>

#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/refine/diagonal.hpp"

namespace pamr::refine {

/// The corners of a base cell, where they lie in the domain and in level 0.
struct BaseCorners {
  geometry::TetPoints point{};
  std::array<mesh::CornerWeights, 4> weights{};
  LocalId row = -1;  ///< of the map; -1: the cell is not bent, and weights are not looked at
};

/// The corners that these nodes are of a cell that descends from the one of a row. Local.
BaseCorners base_corners(const mesh::DistMesh& mesh, const mesh::Level0View& level0, LocalId row,
                         const std::array<LocalId, 4>& node);
/// Of a cell. Local.
BaseCorners base_corners(const mesh::DistMesh& mesh, const mesh::Level0View& level0, LocalId cell);

/// A base cell with the middles of its edges where new nodes would lie: where the map puts them, else in the middle.
/// Each is placed when it is asked for. The view has to live as long.
class MappedPoints {
 public:
  MappedPoints(const mesh::Level0View& level0, const BaseCorners& corners);

  /// A middle may lie elsewhere than in the middle.
  bool is_bent() const { return is_bent_; }
  /// The corners and these middles; others are not valid.
  const SplitPoints& points(EdgeMask middles) const {
    if ((middles & ~known_) != 0) place(middles & ~known_);
    return point_;
  }
  /// The same, but with new nodes at the midpoints of their edges, where backing off can leave them.
  SplitPoints points_gone_back(EdgeMask middles) const;
  /// Bits of the middles that exist already.
  unsigned existing() const { return existing_; }
  /// A middle that exists already.
  void put(int edge, geometry::Vec3 point);
  /// A child of the base cell, given by the codes of its corners.
  BaseCorners child(const std::array<std::int8_t, 4>& code) const;

 private:
  mesh::CornerWeights weights_in_middle(int edge) const;
  void place(unsigned middles) const;

  const mesh::Level0View* level0_;
  BaseCorners corners_;
  mutable SplitPoints point_;
  mutable unsigned known_ = 0;  ///< bits of the middles that are placed
  unsigned existing_ = 0;
  bool is_bent_ = false;
};

}  // namespace pamr::refine
