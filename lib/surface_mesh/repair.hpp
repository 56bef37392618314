// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/base/exact.hpp"
#include "surface_mesh/clean.hpp"
#include "surface_mesh/describe.hpp"
#include "surface_mesh/mend.hpp"

namespace pamr::surface_mesh {

struct RepairOptions {
  double weld = -1;           ///< points this near to each other are one, length unit; negative: 1e-7 of the diagonal
  double max_hole = -1;       ///< holes up to this diagonal are closed, length unit; negative: a tenth of the diagonal
  double min_shell_area = 0;  ///< shells below are dropped, squared length unit
  double feature_angle = 40;  ///< for the description afterwards
  Exact<bool> resolve_intersections = true;
};

/// What every step changed, in the order of the steps, and what is left.
struct Repaired {
  geometry::Triangulation surface;
  double weld = 0, max_hole = 0;  ///< as used
  std::int64_t n_unused_points = 0;
  std::int64_t n_welded_points = 0;
  std::int64_t n_collapsed = 0;  ///< triangles with a point twice, dropped
  std::int64_t n_duplicates = 0;
  Oriented oriented;
  DroppedShells shells;
  std::int64_t n_stitched = 0;  ///< pairs of open edges
  ClosedHoles holes;
  MendedFlat flat;
  Resolved intersections;
  TurnedShells turned;
  Description left;  ///< of the result

  bool has_changed() const;
};

/// Makes any triangles (`geometry::read_soup`) the surface of a body as far as that goes: `left.is_body()` says whether
/// it went all the way. Local, serial. O(n log n) but for holes and self-intersections.
Repaired repair(geometry::Triangulation surface, const RepairOptions& options = {});

/// What was done, a sentence for each step that changed something.
std::vector<std::string> steps_of(const Repaired& repaired);

}  // namespace pamr::surface_mesh
