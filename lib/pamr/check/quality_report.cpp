// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/quality_report.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <string_view>

#include "pamr/check/shape_bound.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/mesh/fingerprint.hpp"
#include "pamr/par/reproducible_sum.hpp"

namespace pamr::check {

namespace {

bool is_all_finite(const geometry::TetPoints& points) {
  return std::all_of(points.begin(), points.end(), geometry::is_finite);
}

bool is_broken(const std::vector<validate::Violation>& violations, std::span<const std::string_view> invariants) {
  return std::any_of(violations.begin(), violations.end(), [&](const validate::Violation& violation) {
    return std::find(invariants.begin(), invariants.end(), violation.invariant) != invariants.end();
  });
}

void measure_volume(const par::Comm& comm, const mesh::DistMesh& mesh, QualityReport& report) {
  par::ExactSum volume;
  std::int64_t inverted = 0;
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const auto p = mesh.points(cell);
    volume.add(geometry::volume(p));
    if (!is_all_finite(p) || geometry::orientation(p[0], p[1], p[2], p[3]) <= 0) ++inverted;
  }
  report.volume = par::reproducible_sums(comm, std::span<par::ExactSum>(&volume, 1)).front();
  report.inverted_cells = comm.sum(inverted);
}

void count_levels(const par::Comm& comm, const mesh::DistMesh& mesh, QualityReport& report) {
  std::array<std::int64_t, 257> count{};  // 256 levels, then closure cells
  for (const auto& lineage : mesh.lineage) {
    ++count[static_cast<std::size_t>(lineage.level())];
    if (lineage.is_closure()) ++count[256];
  }
  comm.sum_in_place(count);
  std::size_t n_levels = 256;
  while (n_levels > 0 && count[n_levels - 1] == 0) --n_levels;
  report.cells_of_level.assign(count.begin(), count.begin() + static_cast<std::ptrdiff_t>(n_levels));
  report.closure_cells = count[256];
}

}  // namespace

QualityReport report_quality(const par::Comm& comm, const mesh::DistMesh& mesh, const QualityOptions& options) {
  constexpr std::array<std::string_view, 6> conformity{"ids_in_range", "unique_cells",   "distinct_corners",
                                                       "conforming",   "border_matches", "boundary_manifold"};
  constexpr std::array<std::string_view, 5> consistency{"ids_in_range", "patches_in_range", "neighbors_reciprocal",
                                                        "conforming", "border_matches"};
  QualityReport report;
  report.cells = mesh.info.n_global_cells;
  report.nodes = mesh.info.n_global_nodes;
  report.violations = validate::validate(comm, mesh);
  report.conforming = !is_broken(report.violations, conformity);
  report.neighbors_consistent = !is_broken(report.violations, consistency);
  measure_volume(comm, mesh, report);
  report.bounding_box_diagonal = bounding_box_diagonal(comm, mesh);
  report.patches = measure_patches(comm, mesh, options.off_surface_tolerance * report.bounding_box_diagonal);
  report.triangles = measure_triangles(comm, mesh);
  report.regions = measure_regions(comm, mesh);
  report.metrics = measure_cells(comm, mesh);
  count_levels(comm, mesh, report);
  report.uniform_shape_bound = worst_uniform_shape(comm, mesh);
  for (const auto& patch : mesh.info.patches) {
    const auto* surface = mesh.info.surfaces->get(patch.surface);
    report.has_curved_walls = report.has_curved_walls || (surface != nullptr && !surface->is_flat());
  }
  report.off_surface = read_off_surface(comm, mesh);
  if (report.is_valid()) report.tears = find_tears(comm, mesh);
  report.fingerprint = mesh::fingerprint(comm, mesh);
  return report;
}

}  // namespace pamr::check
