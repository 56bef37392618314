// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/combination.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>

#include "meshing/feature_curves.hpp"
#include "meshing/pieces.hpp"
#include "meshing/solid.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/surface.hpp"

namespace pamr::meshing {
namespace {

using geometry::Vec3;

/// Looks at a grid of points a little outside each side of the box.
void require_within_bounds(const Solid& solid, const std::string& where) {
  constexpr int n = 40;
  const Vec3 margin = 1e-3 * (solid.high - solid.low), low = solid.low - margin, high = solid.high + margin;
  const auto between = [](double a, double b, int i) { return a + (b - a) * i / n; };
  const auto require_outside = [&](Vec3 p) {
    if (solid.contains(p))
      throw Error(fmt::format("{}: expected bounds that hold the region, found ({:g}, {:g}, {:g}) in it", where, p.x,
                              p.y, p.z));
  };
  for (int i = 0; i <= n; ++i)
    for (int j = 0; j <= n; ++j)
      for (const bool above : {false, true}) {
        const Vec3 side = above ? high : low;
        require_outside({side.x, between(low.y, high.y, i), between(low.z, high.z, j)});
        require_outside({between(low.x, high.x, i), side.y, between(low.z, high.z, j)});
        require_outside({between(low.x, high.x, i), between(low.y, high.y, j), side.z});
      }
}

/// Looks at a grid of points in the box, and beside points of the surfaces, where thin parts of a region are.
void require_some_within_bounds(const Solid& solid, const SurfaceSamples& samples, const std::string& where) {
  constexpr int n = 24;
  const Vec3 size = solid.high - solid.low;
  for (int i = 0; i < n; ++i)
    for (int j = 0; j < n; ++j)
      for (int k = 0; k < n; ++k)
        if (solid.contains(solid.low + Vec3{size.x * (i + 0.5) / n, size.y * (j + 0.5) / n, size.z * (k + 0.5) / n}))
          return;
  const auto is_in_box = [&](Vec3 p) {
    return p.x >= solid.low.x && p.y >= solid.low.y && p.z >= solid.low.z && p.x <= solid.high.x &&
           p.y <= solid.high.y && p.z <= solid.high.z;
  };
  for (int s = 0; s < solid.n_surfaces(); ++s)
    for (const Vec3 p : samples[at(s)]) {
      const Vec3 step = 1e-4 * solid.radius() * solid.surface(s).normal(p);
      for (const Vec3 q : {p + step, p - step})
        if (is_in_box(q) && solid.contains(q)) return;
    }
  throw Error(fmt::format("{}: expected bounds around a part of the region, found none of it in them", where));
}

/// What edges in a gap are bounded to: `factor` times the least sum of the distances from two surfaces whose normals
/// there are within 45 degrees of each other in either sense; at least a sixteenth of `size`.
double bounded_by_gaps(const geometry::SurfaceSet& surfaces, double factor, Vec3 p, double size) {
  constexpr double min_cosine = 0.7071, min_part = 1.0 / 16;
  std::vector<std::pair<double, Vec3>> near;
  for (const auto& surface : surfaces.surface)
    if (const double distance = surface->distance(p); factor * distance < size)
      near.emplace_back(distance, surface->normal(p));
  double bound = size;
  for (std::size_t i = 0; i < near.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (std::abs(geometry::dot(near[i].second, near[j].second)) > min_cosine)
        bound = std::min(bound, factor * (near[i].first + near[j].first));
  return std::max(bound, min_part * size);
}

std::function<double(Vec3)> size_field(const std::shared_ptr<const Solid>& solid, const Combination& c,
                                       const std::string& where) {
  std::vector<std::pair<const geometry::Surface*, double>> near;
  for (const auto& [name, size] : c.near) {
    const auto* surface = solid->surfaces->find(name);
    if (surface == nullptr)
      throw Error(fmt::format("{}: expected the name of a surface for a size, found \"{}\"", where, name));
    near.emplace_back(surface, size);
  }
  return [solid, near, far = c.far, growth = c.growth, factor = c.gap_factor](Vec3 p) {
    double size = far;
    for (const auto& [surface, here] : near)
      if (here < size) size = std::min(size, here + growth * std::max(0.0, surface->distance(p) - here));
    return factor > 0 ? bounded_by_gaps(*solid->surfaces, factor, p, size) : size;
  };
}

/// Points of a piece that bound the solid, far from each other and from the curves: no nearer than edges are wanted
/// there, but at least six where there are so many and no curve is near, and at most `most`.
std::vector<Vec3> scattered_points(const Solid& solid, const Pieces& pieces, int piece,
                                   const std::vector<Vec3>& samples, const std::vector<FeatureCurve>& curves,
                                   const std::function<double(Vec3)>& size) {
  constexpr std::size_t least = 6, most = 60;
  const int i = pieces.all()[static_cast<std::size_t>(piece)].surface;
  const Sides bit = Sides{1} << i;
  std::vector<Vec3> candidates;
  for (const Vec3 p : samples) {
    if (pieces.nearest(i, p) != piece) continue;
    const Sides rest = solid.sides(p) & ~bit;
    if (solid.region.contains(rest) != solid.region.contains(rest | bit)) candidates.push_back(p);
  }
  std::vector<Vec3> chosen;
  std::vector<double> distance(candidates.size(), std::numeric_limits<double>::infinity());
  for (const auto& curve : curves)
    for (std::size_t k = 0; k < candidates.size(); ++k)
      for (const Vec3 p : curve.polyline) distance[k] = std::min(distance[k], geometry::norm(candidates[k] - p));
  while (!candidates.empty() && chosen.size() < most) {
    const auto farthest = std::max_element(distance.begin(), distance.end());
    const Vec3 p = candidates[static_cast<std::size_t>(farthest - distance.begin())];
    if (*farthest == 0 || ((chosen.size() >= least || !curves.empty()) && *farthest < size(p))) break;
    chosen.push_back(p);
    for (std::size_t k = 0; k < candidates.size(); ++k)
      distance[k] = std::min(distance[k], geometry::norm(candidates[k] - p));
  }
  return chosen;
}

/// True when all points of the curves lie in one plane, to 1e-6 of the radius.
bool are_in_one_plane(const std::vector<FeatureCurve>& curves, double radius) {
  std::vector<Vec3> points;
  for (const auto& curve : curves) points.insert(points.end(), curve.polyline.begin(), curve.polyline.end());
  if (points.empty()) return false;
  const auto farthest = [&](auto&& distance) {
    return *std::max_element(points.begin(), points.end(), [&](Vec3 a, Vec3 b) { return distance(a) < distance(b); });
  };
  const Vec3 a = points.front(), b = farthest([&](Vec3 p) { return geometry::norm(p - a); });
  const auto square_to_line = [&](Vec3 p) { return geometry::cross(b - a, p - a); };
  const Vec3 normal = square_to_line(farthest([&](Vec3 p) { return geometry::norm(square_to_line(p)); }));
  const double length = geometry::norm(normal);
  return std::all_of(points.begin(), points.end(),
                     [&](Vec3 p) { return std::abs(geometry::dot(p - a, normal)) <= 1e-6 * radius * length; });
}

}  // namespace

Domain combine(const Combination& c, const std::string& where) {
  const Region region(c.region, c.surfaces->name, where);
  const auto solid = std::make_shared<const Solid>(Solid{c.surfaces, region, c.low, c.high});
  const auto samples = sample_surfaces(*solid);
  const auto with_place = [&where](auto&& make) {
    try {
      return make();
    } catch (const Error& error) {
      throw Error(where + ": " + error.what());
    }
  };
  const auto pieces = with_place([&] { return std::make_shared<const Pieces>(solid, samples); });
  require_within_bounds(*solid, where);
  require_some_within_bounds(*solid, samples, where);
  Domain domain;
  domain.label = [solid, pieces](Vec3 p) {
    const int surface = solid->label(p);
    return surface < 0 ? Domain::inside : pieces->nearest(surface, p);
  };
  domain.size = size_field(solid, c, where);
  for (const auto& piece : pieces->all()) {
    const int number = static_cast<int>(domain.pieces.size());
    domain.pieces.push_back({number, [pieces, shape = piece.shape](Vec3 p) { return shape->project(p); }});
    domain.patches.push_back({piece.name, "patch", piece.surface});
  }
  domain.curves = with_place([&] { return trace_feature_curves(solid, pieces, samples); });
  for (auto& crease : pieces->creases()) domain.curves.push_back(std::move(crease));
  domain.curves_in_one_plane = are_in_one_plane(domain.curves, solid->radius());
  for (std::size_t k = 0; k < domain.pieces.size(); ++k) {
    const auto& piece = pieces->all()[k];
    const bool has_curve = std::any_of(domain.curves.begin(), domain.curves.end(), [&](const FeatureCurve& curve) {
      return piece.shape->distance(curve.polyline[curve.polyline.size() / 2]) < 1e-9 * solid->radius();
    });
    if (!has_curve || domain.curves_in_one_plane)
      domain.pieces[k].start =
          scattered_points(*solid, *pieces, static_cast<int>(k), samples[static_cast<std::size_t>(piece.surface)],
                           has_curve ? domain.curves : std::vector<FeatureCurve>{}, domain.size);
  }
  domain.surfaces = c.surfaces;
  domain.length_unit = c.length_unit;
  domain.center = solid->center();
  domain.radius = 1.05 * solid->radius();
  return domain;
}

}  // namespace pamr::meshing
