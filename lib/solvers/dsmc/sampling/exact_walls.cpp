// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/exact_walls.hpp"

#include <algorithm>
#include <array>

#include "pamr/base/index.hpp"
#include "pamr/geometry/surface.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

constexpr int n_cuts = 4;  ///< of an edge

/// The point of a surface near a point of a face, m; the point itself where the surface is not near by.
Vec3 point_on(const Surface& surface, Vec3 point, double size, double unit) {
  const Vec3 foot = unit * surface.project((1 / unit) * point);
  return norm(foot - point) <= size ? foot : point;
}

void add_parts(const BoundaryFace& face, const Surface& surface, double unit, std::vector<BoundaryFace>& parts) {
  const auto& [a, b, c] = face.corner;
  const double size = std::max({norm(b - a), norm(c - b), norm(a - c)});
  std::array<std::array<Vec3, n_cuts + 1>, n_cuts + 1> grid{};
  for (int i = 0; i <= n_cuts; ++i)
    for (int j = 0; i + j <= n_cuts; ++j) {
      const double u = static_cast<double>(i) / n_cuts, v = static_cast<double>(j) / n_cuts;
      grid[at(i)][at(j)] = point_on(surface, a + u * (b - a) + v * (c - a), size, unit);
    }
  const auto add = [&](Vec3 p, Vec3 q, Vec3 r) {
    const Vec3 normal = 0.5 * cross(q - p, r - p);
    const double area = norm(normal);
    if (!(area > 0)) return;
    auto part = face;
    part.corner = {p, q, r};
    part.area = area;
    part.normal = (dot(normal, face.normal) < 0 ? -1 / area : 1 / area) * normal;
    parts.push_back(part);
  };
  for (int i = 0; i < n_cuts; ++i)
    for (int j = 0; i + j < n_cuts; ++j) {
      add(grid[at(i)][at(j)], grid[at(i + 1)][at(j)], grid[at(i)][at(j + 1)]);
      if (i + j + 1 < n_cuts) add(grid[at(i + 1)][at(j)], grid[at(i + 1)][at(j + 1)], grid[at(i)][at(j + 1)]);
    }
}

}  // namespace

std::vector<BoundaryFace> faces_on_surfaces(const std::vector<BoundaryFace>& faces,
                                            const std::vector<mesh::Patch>& patches, const SurfaceSet& surfaces,
                                            double unit) {
  std::vector<BoundaryFace> parts;
  for (const auto& face : faces) {
    const auto* surface = surfaces.get(patches[at(face.patch)].surface);
    if (surface)
      add_parts(face, *surface, unit, parts);
    else
      parts.push_back(face);
  }
  return parts;
}

}  // namespace pamr::dsmc
