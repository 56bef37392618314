// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/patch_list.hpp"

namespace pamr::refine {

using mesh::PatchList;

/// A node that may leave the middle of its edge: where it lies when nothing moves and where it wants to go.
struct Movable {
  LocalId node = invalid_local;  ///< in the refined mesh
  geometry::Vec3 base;
  geometry::Vec3 target;
  PatchList patch{-1, -1, -1, -1};  ///< patches whose surfaces it belongs to; none: an inner node
  bool is_reachable = true;         ///< false: no common point of its surfaces was found near by, `target` is `base`
  bool is_on_crease = false;        ///< on a sharp edge inside its surface
  double off_facets = 0;            ///< how far the target leaves the faces of a patch without a surface
  geometry::Vec3 beside{};          ///< normal of the face of such a patch at a new node, else 0
  bool is_sharp = false;            ///< it meets that face in a sharp edge
};

}  // namespace pamr::refine
