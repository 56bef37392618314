// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/io/export/write_surface_vtu.hpp"

namespace pamr::io {

/// The triangles at the canonical blocks of their cells, in the order of a file: by cell, those of one cell as given.
/// Collective: two sparse exchanges.
SurfaceTriangles triangles_in_order(const par::Comm& comm, const SurfaceTriangles& given);

/// The points of a surface as a file numbers them.
struct SurfacePoints {
  std::vector<geometry::Vec3> own;   ///< those first used by this rank's triangles, by number
  std::int64_t n = 0;                ///< on all ranks
  std::vector<std::int64_t> number;  ///< of each corner of this rank's triangles
};

/// Each corner is a point. Collective.
SurfacePoints points_of_their_own(const par::Comm& comm, const SurfaceTriangles& t);
/// Equal corners are one point. The ranks hold the triangles in the order of the file, so a point is first used on the
/// lowest rank that has it, which numbers it. Collective: a sparse exchange and one with the ranks that share points.
SurfacePoints shared_points(const par::Comm& comm, const SurfaceTriangles& t);

}  // namespace pamr::io
