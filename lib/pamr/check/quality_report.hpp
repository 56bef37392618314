// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pamr/check/boundary_report.hpp"
#include "pamr/check/metrics.hpp"
#include "pamr/check/region_report.hpp"
#include "pamr/check/tears.hpp"
#include "pamr/check/triangle_metrics.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "pamr/validate/validate.hpp"

namespace pamr::check {

struct QualityOptions {
  /// Distance beyond which a boundary node counts as off its surface, as a part of the bounding box's diagonal.
  double off_surface_tolerance = 1e-12;
};

/// What is to be known about the quality of a mesh.
struct QualityReport {
  std::int64_t cells = 0;
  std::int64_t nodes = 0;
  double volume = 0;                 ///< sum of the cells' signed volumes, cubic length unit
  double bounding_box_diagonal = 0;  ///< length unit
  std::vector<PatchReport> patches;
  std::vector<TriangleReport> triangles;  ///< of each patch
  std::vector<RegionReport> regions;
  std::int64_t inverted_cells = 0;  ///< volume not positive by exact arithmetic, or corners that are not finite
  bool conforming = false;          ///< every inner face in exactly two cells, the boundary closed and manifold
  bool neighbors_consistent =
      false;  ///< neighbors name each other across the same nodes, from opposite sides; other faces in a patch
  std::vector<validate::Violation> violations;  ///< of all invariants; empty: the mesh is valid
  std::vector<MetricReport> metrics;
  std::vector<std::int64_t> cells_of_level;  ///< cells whose base cell has level 0, 1, ...
  std::int64_t closure_cells = 0;
  double uniform_shape_bound = 0;  ///< `worst_uniform_shape` of the mesh, which holds away from curved walls
  bool has_curved_walls = false;   ///< a patch lies on a surface that is not flat
  OffSurface off_surface;
  std::optional<Tears> tears;  ///< of valid meshes
  std::uint64_t fingerprint = 0;

  bool is_valid() const { return violations.empty() && inverted_cells == 0; }
};

/// Measures a mesh; never throws because the mesh is bad.
/// Every number is the same for every number of ranks, partition and order of the cells, to the last bit.
/// Collective. O(cells) and what `validate::validate` takes.
QualityReport report_quality(const par::Comm& comm, const mesh::DistMesh& mesh, const QualityOptions& options = {});

}  // namespace pamr::check
