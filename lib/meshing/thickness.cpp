// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/thickness.hpp"

#include <algorithm>
#include <cmath>

namespace pamr::meshing {
namespace {

using geometry::Vec3;

double thickness_behind(const geometry::Surface& surface, Vec3 point, Vec3 normal, double most) {
  constexpr double first = 1e-3, shortest = 0.01;  // steps, of `most`
  constexpr double landed = 1e-3;                  // of the way
  constexpr double opposite = -0.9659;             // cosine: within 15 degrees of parallel, which no wedge is
  for (double way = first * most; way < most;) {
    const Vec3 here = point - way * normal;
    const double inside = -surface.signed_distance(here);
    if (inside < landed * way) {  // beside a part along the way, or at one across it
      if (dot(surface.normal(here), normal) < opposite)
        return inside < -landed * way ? way + inside : way;  // a shortest step may lead beyond
      if (inside <= 0) return most;
    }
    way += std::max(inside, shortest * most);
  }
  return most;
}

}  // namespace

std::vector<Thickness> thicknesses(const geometry::Surface& surface, std::span<const std::array<Vec3, 3>> triangles,
                                   const ThicknessOptions& options) {
  // Source of the sequence of points: M. Roberts, The unreasonable effectiveness of quasirandom sequences, 2018.
  constexpr double step_u = 0.7548776662466927, step_v = 0.5698402909980532;
  const auto twice_area = [](const std::array<Vec3, 3>& p) { return cross(p[1] - p[0], p[2] - p[0]); };
  double whole = 0;
  for (const auto& p : triangles) whole += 0.5 * norm(twice_area(p));
  const double area = std::max(options.spacing * options.spacing, whole / options.max_places);
  std::vector<Thickness> result;
  double rest = 0.5 * area, u = 0.5, v = 0.5;
  for (const auto& p : triangles) {
    const Vec3 normal = twice_area(p);
    const double twice = norm(normal);
    for (rest += 0.5 * twice; rest >= area; rest -= area) {
      u = u + step_u < 1 ? u + step_u : u + step_u - 1;
      v = v + step_v < 1 ? v + step_v : v + step_v - 1;
      const bool is_beyond = u + v > 1;
      const Vec3 place = p[0] + (is_beyond ? 1 - u : u) * (p[1] - p[0]) + (is_beyond ? 1 - v : v) * (p[2] - p[0]);
      result.push_back({place, thickness_behind(surface, place, (1 / twice) * normal, options.most), area});
    }
  }
  return result;
}

}  // namespace pamr::meshing
