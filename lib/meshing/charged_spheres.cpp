// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/charged_spheres.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <memory>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/geometry/described_surface.hpp"

namespace pamr::meshing {
namespace {

using geometry::described_plane, geometry::described_sphere, geometry::digits, geometry::Vec3;

constexpr double padding = 7.5;
/// Longest edge on a sphere, in radii, that leaves every new node in its middle a safe way to the surface.
constexpr double max_on_sphere = 0.6;

void require(bool holds, const std::string& expected) {
  if (!holds) throw Error("expected " + expected);
}

geometry::SharedSurfaces shared(std::vector<geometry::DescribedSurface> surfaces, const char* shape) {
  return std::make_shared<const geometry::SurfaceSet>(geometry::set_of(surfaces, shape));
}

void require_sizes(double on_sphere, double radius, double far, double growth) {
  require(on_sphere > 0 && on_sphere <= max_on_sphere * radius,
          fmt::format("an edge length at the sphere between 0 and {:g} radii, found {:g} at radius {:g}", max_on_sphere,
                      on_sphere, radius));
  require(far >= on_sphere,
          fmt::format("a largest edge length of at least that at the sphere, {:g}, found {:g}", on_sphere, far));
  require(growth >= 0.05 && growth <= 0.8, fmt::format("growth between 0.05 and 0.8, found {:g}", growth));
}

}  // namespace

Combination charged_spheres(const ChargedSpheres& given) {
  auto p = given;
  const bool has_plate = p.height > 0;
  const auto fill = [](double& value, double otherwise) {
    if (value == 0) value = otherwise;
  };
  fill(p.half_length, p.distance / 2 + padding);
  fill(p.width, padding);
  fill(p.top, p.height + padding);
  fill(p.size_sphere, std::min(0.15 * p.far, max_on_sphere * p.radius));
  fill(p.size_plate, 0.5 * p.far);
  fill(p.size_walls, p.far);
  require(p.radius > 0, fmt::format("a radius > 0, found {:g}", p.radius));
  require(p.distance > 2 * p.radius,
          fmt::format("a distance of the centers over two radii, {:g}, found {:g}", 2 * p.radius, p.distance));
  require(!has_plate || p.height > p.radius,
          fmt::format("a height of the centers over the radius, {:g}, found {:g}", p.radius, p.height));
  require(p.half_length > p.distance / 2 + p.radius && p.width > p.radius && p.top > p.height + p.radius,
          fmt::format("walls beyond the sphere, found half_length {:g}, width {:g}, top {:g}", p.half_length, p.width,
                      p.top));
  require_sizes(p.size_sphere, p.radius, p.far, p.growth);
  require(p.size_plate > 0 && p.size_walls > 0, "edge lengths > 0");

  const std::string floor = has_plate ? "plate" : "symmetry_z";
  Combination result;
  result.surfaces = shared(
      {described_sphere("sphere", digits(Vec3{p.distance / 2, 0, p.height}), digits(p.radius)),
       described_plane(floor, 2, 0), described_plane("symmetry_x", 0, 0), described_plane("symmetry_y", 1, 0),
       described_plane("end", 0, p.half_length), described_plane("side", 1, p.width), described_plane("lid", 2, p.top)},
      "charged-spheres");
  result.region = "+sphere & +" + floor + " & +symmetry_x & +symmetry_y & -end & -side & -lid";
  result.high = {p.half_length, p.width, p.top};
  result.length_unit = "1";
  result.far = p.far;
  result.growth = p.growth;
  result.near = {{"sphere", p.size_sphere}};
  if (has_plate) result.near.emplace_back("plate", p.size_plate);
  for (const char* wall : {"end", "side", "lid"}) result.near.emplace_back(wall, p.size_walls);
  return result;
}

Combination charged_sphere(const ChargedSphere& given) {
  auto p = given;
  if (p.outer_radius == 0) p.outer_radius = p.radius + 8;
  if (p.size_sphere == 0) p.size_sphere = std::min(0.25 * p.radius, p.far);
  if (p.size_outer == 0) p.size_outer = p.far;
  require(p.radius > 0, fmt::format("a radius > 0, found {:g}", p.radius));
  require(p.outer_radius > p.radius,
          fmt::format("an outer radius over the radius, {:g}, found {:g}", p.radius, p.outer_radius));
  require_sizes(p.size_sphere, p.radius, p.far, p.growth);
  require(p.size_outer > 0 && p.size_outer <= max_on_sphere * p.outer_radius,
          fmt::format("an edge length at the outer sphere between 0 and {:g} of its radius, found {:g}", max_on_sphere,
                      p.size_outer));
  Combination result;
  result.surfaces =
      shared({described_sphere("sphere", digits(Vec3{}), digits(p.radius)),
              described_sphere("outer", digits(Vec3{}), digits(p.outer_radius)), described_plane("symmetry_x", 0, 0),
              described_plane("symmetry_y", 1, 0), described_plane("symmetry_z", 2, 0)},
             "charged-sphere");
  result.region = "+sphere & -outer & +symmetry_x & +symmetry_y & +symmetry_z";
  result.high = {p.outer_radius, p.outer_radius, p.outer_radius};
  result.length_unit = "1";
  result.far = p.far;
  result.growth = p.growth;
  result.near = {{"sphere", p.size_sphere}, {"outer", p.size_outer}};
  return result;
}

}  // namespace pamr::meshing
