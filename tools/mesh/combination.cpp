// SPDX-License-Identifier: GPL-3.0-or-later
#include "mesh/combination.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>

#include "mesh/feature_curves.hpp"
#include "mesh/solid.hpp"
#include "pamr/base/error.hpp"
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

std::function<double(Vec3)> size_field(const std::shared_ptr<const Solid>& solid, const Combination& c,
                                       const std::string& where) {
  std::vector<std::pair<const geometry::Surface*, double>> near;
  for (const auto& [name, size] : c.near) {
    const auto* surface = solid->surfaces->find(name);
    if (surface == nullptr)
      throw Error(fmt::format("{}: expected the name of a surface for a size, found \"{}\"", where, name));
    near.emplace_back(surface, size);
  }
  return [solid, near, far = c.far, growth = c.growth](Vec3 p) {
    double size = far;
    for (const auto& [surface, here] : near)
      if (here < size) size = std::min(size, here + growth * std::max(0.0, surface->distance(p) - here));
    return size;
  };
}

}  // namespace

Domain combine(const Combination& c, const std::string& where) {
  auto surfaces = std::make_shared<const geometry::SurfaceSet>(geometry::surfaces_from_toml(c.surfaces_toml, where));
  const Region region(c.region, surfaces->name, where);
  const auto solid = std::make_shared<const Solid>(Solid{std::move(surfaces), region, c.low, c.high});
  require_within_bounds(*solid, where);
  Domain domain;
  domain.label = [solid](Vec3 p) { return solid->label(p); };
  domain.size = size_field(solid, c, where);
  for (int i = 0; i < solid->n_surfaces(); ++i) {
    domain.pieces.push_back({i, [solid, i](Vec3 p) { return solid->surface(i).project(p); }});
    domain.patches.push_back({solid->name(i), "patch", solid->name(i)});
  }
  try {
    domain.curves = trace_feature_curves(solid);
  } catch (const Error& error) {
    throw Error(where + ": " + error.what());
  }
  domain.surfaces_toml = c.surfaces_toml;
  domain.length_unit = c.length_unit;
  domain.centre = solid->centre();
  domain.radius = 1.05 * solid->radius();
  return domain;
}

}  // namespace pamr::meshing
