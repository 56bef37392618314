// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/surface.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <vector>

#include "pamr/geometry/parameters.hpp"
#include "pamr/geometry/shared_edges.hpp"

namespace pamr::geometry {

namespace {

constexpr int iteration_limit = 50;
constexpr double sine_of_5_degrees = 0.08715574274765817;
constexpr double min_independence = 1e-3;  // sine between a normal and the span of those before it
constexpr double move_limit = 32;          // times the largest distance; 2 surfaces at 5 degrees need 23
constexpr double step_tolerance = 1e-15;   // this and the next: relative to the size of the numbers
constexpr double distance_tolerance = 1e-13;

/// One surface seen from a point: its tangent plane at the nearest point.
struct TangentPlane {
  const Surface* surface = nullptr;
  Vec3 normal;
  double distance = 0;         // not negative
  double signed_distance = 0;  // along the normal
};

TangentPlane tangent_plane(const Surface* surface, Vec3 point) {
  const Vec3 from_foot = point - surface->project(point), normal = surface->normal(point);
  return {surface, normal, norm(from_foot), dot(from_foot, normal)};
}

/// The surfaces by growing distance from the point; those equally near to within rounding keep their order.
std::vector<const Surface*> by_nearness(std::span<const Surface* const> surfaces, Vec3 point, double tolerance) {
  std::vector<const Surface*> rest(surfaces.begin(), surfaces.end()), ordered;
  while (!rest.empty()) {
    double least = std::numeric_limits<double>::infinity();
    for (const Surface* surface : rest) least = std::min(least, surface->distance(point));
    auto next = std::find_if(rest.begin(), rest.end(),
                             [&](const Surface* surface) { return surface->distance(point) <= least + tolerance; });
    if (next == rest.end()) next = rest.begin();  // distances that are not numbers: any order will do
    ordered.push_back(*next);
    rest.erase(next);
  }
  return ordered;
}

/// Takes out each surface that meets one before it at under 5 degrees.
void drop_nearly_tangent(std::vector<TangentPlane>& planes) {
  std::vector<TangentPlane> kept;
  for (const TangentPlane& plane : planes) {
    const bool is_tangent = std::any_of(kept.begin(), kept.end(), [&](const TangentPlane& other) {
      return norm(cross(plane.normal, other.normal)) < sine_of_5_degrees;
    });
    if (!is_tangent) kept.push_back(plane);
  }
  planes.swap(kept);
}

/// The shortest step onto all tangent planes, by Gram-Schmidt on their normals: coordinates of the step along an
/// orthonormal basis follow one after another. Planes whose normal depends on those before are left out.
Vec3 shortest_step(const std::vector<TangentPlane>& planes) {
  std::array<Vec3, 3> basis;
  std::size_t n_basis = 0;
  Vec3 step;
  for (const TangentPlane& plane : planes) {
    Vec3 rest = plane.normal;
    for (int pass = 0; pass < 2; ++pass)  // twice is enough for orthogonality to rounding
      for (std::size_t i = 0; i < n_basis; ++i) rest = rest - dot(rest, basis[i]) * basis[i];
    const double length = norm(rest);
    if (n_basis == 3 || !(length > min_independence)) continue;
    const Vec3 direction = (1.0 / length) * rest;
    basis[n_basis++] = direction;
    step = step - ((plane.signed_distance + dot(step, plane.normal)) / dot(direction, plane.normal)) * direction;
  }
  return step;
}

double largest_distance(const std::vector<TangentPlane>& planes) {
  double largest = 0;
  for (const TangentPlane& plane : planes) largest = std::max(largest, plane.distance);
  return largest;
}

}  // namespace

Projected project_onto_all(std::span<const Surface* const> surfaces, Vec3 point) {
  if (surfaces.empty()) return {point, true};
  if (surfaces.size() == 1) return {surfaces[0]->project(point), true};
  if (const auto* known = dynamic_cast<const SharedEdges*>(surfaces[0]))
    if (const auto common = known->project_to_common(surfaces, point)) return {*common, true};
  double scale = largest_coordinate(point);
  for (const Surface* surface : surfaces) scale = std::max(scale, surface->magnitude());

  std::vector<TangentPlane> planes;
  for (const Surface* surface : by_nearness(surfaces, point, distance_tolerance * scale))
    planes.push_back(tangent_plane(surface, point));
  drop_nearly_tangent(planes);
  if (planes.size() == 1) return {planes[0].surface->project(point), true};

  const double reach = move_limit * std::max(largest_distance(planes), distance_tolerance * scale);
  Vec3 current = point, best = point;
  double least = std::numeric_limits<double>::infinity(), last_step = least;
  for (int iteration = 0; iteration < iteration_limit; ++iteration) {
    for (TangentPlane& plane : planes) plane = tangent_plane(plane.surface, current);
    const double distance = largest_distance(planes);
    if (distance < least) {
      least = distance;
      best = current;
    }
    const Vec3 step = shortest_step(planes);
    const double length = norm(step);
    current = current + step;
    const bool is_at_rest = length <= step_tolerance * scale;
    const bool is_rounding = length <= distance_tolerance * scale && !(length < 0.5 * last_step);
    if (is_at_rest || is_rounding || !(norm(current - point) <= reach)) break;
    last_step = length;
  }
  return {best, least <= distance_tolerance * scale};
}

double distance_from_all(std::span<const Surface* const> surfaces, Vec3 point) {
  double largest = 0;
  for (const Surface* surface : surfaces) largest = std::max(largest, surface->distance(point));
  return largest;
}

}  // namespace pamr::geometry
