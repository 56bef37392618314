// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/polygons.hpp"

#include <array>
#include <limits>
#include <utility>

#include "pamr/base/index.hpp"

namespace pamr::geometry {

namespace {

/// Source: M. Newell; in D. F. Rogers, Procedural Elements for Computer Graphics, 1985.
Vec3 mean_normal(std::span<const int> corner, const std::vector<Vec3>& point) {
  Vec3 sum;
  const Vec3 origin = point[at(corner[0])];
  for (std::size_t i = 0; i < corner.size(); ++i)
    sum = sum + cross(point[at(corner[i])] - origin, point[at(corner[(i + 1) % corner.size()])] - origin);
  return sum;
}

/// Whether the triangle at corner `k` lies inside of the face and holds no other corner of it.
bool can_be_cut_off(std::span<const int> corner, std::size_t k, Vec3 normal, const std::vector<Vec3>& point) {
  const auto n = corner.size();
  const std::array<int, 3> number{corner[(k + n - 1) % n], corner[k], corner[(k + 1) % n]};
  const auto p = [&](std::size_t i) { return point[at(number[i % 3])]; };
  if (!(dot(cross(p(1) - p(0), p(2) - p(1)), normal) > 0)) return false;
  for (const int other : corner) {
    if (other == number[0] || other == number[1] || other == number[2]) continue;
    bool is_inside = true;
    for (std::size_t i = 0; i < 3; ++i)
      is_inside = is_inside && dot(cross(p(i + 1) - p(i), point[at(other)] - p(i)), normal) >= 0;
    if (is_inside) return false;
  }
  return true;
}

void split_face(std::span<const int> face, Triangulation& surface) {
  std::vector<int> left(face.begin(), face.end());
  const Vec3 normal = mean_normal(face, surface.points);
  while (left.size() > 3) {
    const auto n = left.size();
    std::size_t best = 0;
    std::pair least{true, std::numeric_limits<double>::infinity()};  // corners that cannot be cut off come last: those
    for (std::size_t k = 0; k < n; ++k) {                            // of faces on a line, or that cut themselves
      const double length =
          squared_norm(surface.points[at(left[(k + 1) % n])] - surface.points[at(left[(k + n - 1) % n])]);
      if (!least.first && length >= least.second) continue;
      const std::pair here{!can_be_cut_off(left, k, normal, surface.points), length};
      if (!(here < least)) continue;
      best = k;
      least = here;
    }
    surface.triangles.push_back({left[(best + n - 1) % n], left[best], left[(best + 1) % n]});
    left.erase(left.begin() + static_cast<std::ptrdiff_t>(best));
  }
  surface.triangles.push_back({left[0], left[1], left[2]});
}

}  // namespace

void Polygons::split(Triangulation& surface) const {
  std::size_t begin = 0;
  for (const auto end : end_) {
    split_face(std::span(corner_).subspan(begin, end - begin), surface);
    begin = end;
  }
}

}  // namespace pamr::geometry
