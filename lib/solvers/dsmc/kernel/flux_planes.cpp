// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/flux_planes.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"

namespace pamr::dsmc {

using namespace geometry;

bool FluxPlane::holds(Vec3 p) const {
  const Vec3 r = p - point;
  if (radius > 0) return squared_norm(r) < radius * radius;
  const double area = dot(cross(along, across), normal);
  if (area == 0) return true;
  const double s = dot(cross(r, across), normal) / area, t = dot(cross(along, r), normal) / area;
  return s >= 0 && s < 1 && t >= 0 && t < 1;
}

int FluxPlane::crossing(Vec3 a, Vec3 b) const {
  const bool begins_ahead = is_ahead(a), ends_ahead = is_ahead(b);
  if (begins_ahead == ends_ahead) return 0;
  const double from = dot(normal, a - point), to = dot(normal, b - point);
  const Vec3 at = a + (from / (from - to)) * (b - a);
  if (!holds(at)) return 0;
  return ends_ahead ? 1 : -1;
}

FluxPlanes place_planes(const par::Comm& comm, const mesh::DistMesh& mesh, double unit, std::vector<FluxPlane> planes) {
  constexpr double rounding = 1e-9;  // of coordinates, amply
  FluxPlanes placed{std::move(planes), std::vector<std::uint8_t>(at(mesh.n_cells()), 0)};
  for (const auto& plane : placed.plane) {
    bool is_met = false;
    for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
      double low = 0, high = 0, size = norm(plane.point);
      bool is_first = true;
      for (const auto& corner : corners(mesh, unit, cell)) {
        const double height = dot(plane.normal, corner - plane.point);
        low = is_first ? height : std::min(low, height);
        high = is_first ? height : std::max(high, height);
        size = std::max(size, norm(corner));
        is_first = false;
      }
      if (low > rounding * size || high < -rounding * size) continue;
      placed.cuts_cell[at(cell)] = 1;
      is_met = true;
    }
    if (!comm.any(is_met))
      throw Error(fmt::format("[[plane]] \"{}\": expected a plane that cuts the mesh, found none of its cells there",
                              plane.name));
  }
  return placed;
}

}  // namespace pamr::dsmc
