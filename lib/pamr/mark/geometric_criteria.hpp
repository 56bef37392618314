// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string_view>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/mark/indicator.hpp"

namespace pamr::mark {

/// Criteria that look at where a cell is. A cell that meets one gets infinity. Coordinates are compared as they are
/// stored, without rounding: they are the same bits on every rank.

/// Every cell. Local.
Indicator all_cells(const mesh::DistMesh& mesh);

struct Sphere {
  geometry::Vec3 center;
  double radius = 0;
};

/// Cells that a sphere passes through: least distance of a corner from the center < radius < greatest. Local.
Indicator crossing_sphere(const mesh::DistMesh& mesh, const Sphere& sphere);

/// Cells whose centroid is nearer to a sphere than `width`: |distance from the center - radius| < width. Local.
Indicator centroid_in_shell(const mesh::DistMesh& mesh, const Sphere& sphere, double width);

/// Cells whose centroid lies in the closed box between two corners. Local.
Indicator centroid_in_box(const mesh::DistMesh& mesh, geometry::Vec3 low, geometry::Vec3 high);

/// Cells near a boundary patch, or near all patches for which a pattern stands (`mesh::find_patches`). The first layer
/// are the cells with a face there; each further layer are the cells that share a node with the layer before.
/// Collective: finds the shared nodes once, then one exchange a layer. Throws `Error` on every rank when the mesh has
/// no such patch or `layers` is less than 1.
Indicator near_patch(const par::Comm& comm, const mesh::DistMesh& mesh, std::string_view patch, Exact<int> layers = 1);

}  // namespace pamr::mark
