// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/check/triangle_metrics.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>

#include "pamr/base/index.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::check {

namespace {

constexpr double endless = std::numeric_limits<double>::infinity();
using Scale = MetricTally::Scale;

/// What is gathered of a patch.
struct Gathered {
  MetricTally metrics{{{"mean_ratio", Scale::to_one},
                       {"aspect_ratio", Scale::powers},
                       {"min_angle", Scale::degrees},
                       {"max_angle", Scale::degrees}}};
  par::ExactSum area, area_distance;
  double worst = 0;
};

}  // namespace

std::array<double, 4> triangle_metrics(const std::array<geometry::Vec3, 3>& p) {
  const auto ab = p[1] - p[0], bc = p[2] - p[1], ca = p[0] - p[2];
  const double twice_area = norm(cross(ab, ca)), a = norm(ab), b = norm(bc), c = norm(ca);
  const double squares = a * a + b * b + c * c;
  if (!(twice_area > 0) || !std::isfinite(squares)) return {0, endless, 0, 180};
  const double root_3 = std::numbers::sqrt3, longest = std::max({a, b, c}), inner_radius = twice_area / (a + b + c);
  const auto angle = [](geometry::Vec3 u, geometry::Vec3 v) {
    return std::atan2(norm(cross(u, v)), dot(u, v)) * 180 / std::numbers::pi;
  };
  const std::array<double, 3> angles{angle(ab, -ca), angle(bc, -ab), angle(ca, -bc)};
  return {2 * root_3 * twice_area / squares, longest / (2 * root_3 * inner_radius),
          *std::min_element(angles.begin(), angles.end()), *std::max_element(angles.begin(), angles.end())};
}

std::vector<TriangleReport> measure_triangles(const par::Comm& comm, const mesh::DistMesh& mesh) {
  std::vector<Gathered> gathered(mesh.info.patches.size());
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell)
    for (std::size_t face = 0; face < 4; ++face) {
      const auto slot = mesh.cell_to_cell[at(cell)][face];
      if (slot >= 0 || at(mesh::slot_to_patch(slot)) >= gathered.size()) continue;
      const auto patch = mesh::slot_to_patch(slot);
      auto& here = gathered[at(patch)];
      const auto points = mesh.points(cell);
      std::array<geometry::Vec3, 3> p;
      for (std::size_t k = 0; k < 3; ++k) p[k] = points[at(mesh::tet::face_to_corner[face][k])];
      const auto values = triangle_metrics(p);
      for (std::size_t m = 0; m < values.size(); ++m) here.metrics.add(m, values[m]);
      const auto* surface = mesh.info.surface_of(patch);
      if (surface == nullptr) continue;
      const auto middle = (1.0 / 3) * (p[0] + p[1] + p[2]);
      const double distance = is_finite(middle) ? surface->distance(middle) : endless;
      const double area = 0.5 * norm(cross(p[1] - p[0], p[2] - p[0]));
      here.worst = std::max(here.worst, distance);
      here.area.add(area);
      here.area_distance.add(area * distance);
    }
  std::vector<TriangleReport> reports;
  std::vector<par::ExactSum> areas, distances;
  for (const auto& here : gathered) {
    areas.push_back(here.area);
    distances.push_back(here.area_distance);
  }
  const auto area = par::reproducible_sums(comm, areas), distance = par::reproducible_sums(comm, distances);
  for (std::size_t patch = 0; patch < gathered.size(); ++patch)
    reports.push_back({gathered[patch].metrics.report(comm), area[patch] > 0 ? distance[patch] / area[patch] : 0,
                       comm.max(gathered[patch].worst)});
  return reports;
}

}  // namespace pamr::check
