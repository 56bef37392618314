// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/mesh/patch_list.hpp"

namespace pamr::mesh {

/// The surfaces that a node on some patches lies on.
struct SurfacesOfNode {
  std::vector<const geometry::Surface*> surface;  ///< without repeats, in patch order
  bool is_on_seam = false;   ///< two patches of one surface: their border is a curve of that surface
  int without_surface = -1;  ///< one of the patches that has no surface, -1: every one has

  /// The place on them that a node at `point` belongs to. `converged` is false when there is none near by.
  geometry::Projected place(geometry::Vec3 point) const {
    if (is_on_seam) return {surface.front()->project_to_seam(point), true};
    return geometry::project_onto_all(surface, point);
  }
};
SurfacesOfNode surfaces_of_node(const MeshInfo& info, const geometry::SurfaceSet& surfaces, const PatchList& patch);

}  // namespace pamr::mesh
