// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/supersonic_sphere.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <numbers>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/geometry/described_surface.hpp"

namespace pamr::meshing {
namespace {

using geometry::described_plane, geometry::digits, geometry::Vec3, geometry::whole;

void require(bool holds, const std::string& expected) {
  if (!holds) throw Error("expected " + expected);
}

}  // namespace

Combination supersonic_sphere(const SupersonicSphere& given) {
  auto p = given;
  const auto fill = [](double& value, double otherwise) {
    if (value == 0) value = otherwise;
  };
  fill(p.inflow, 4 * p.radius);
  fill(p.outflow, 6 * p.radius);
  fill(p.side, 5 * p.radius);
  fill(p.far, 0.8 * p.radius);
  fill(p.size_sphere, std::min(0.25 * p.far, 0.6 * p.radius));
  require(p.radius > 0, fmt::format("a radius > 0, found {:g}", p.radius));
  require(p.parts >= 2 && p.parts <= 32 && p.parts == std::floor(p.parts),
          fmt::format("2 to 32 parts of a turn, found {:g}", p.parts));
  require(p.inflow > p.radius && p.outflow > p.radius && p.side > p.radius,
          fmt::format("borders beyond the sphere, found inflow {:g}, outflow {:g}, side {:g}", p.inflow, p.outflow,
                      p.side));
  require(p.size_sphere > 0 && p.size_sphere <= 0.6 * p.radius,
          fmt::format("an edge length at the sphere up to 0.6 radii, {:g} at radius {:g}, found {:g}", 0.6 * p.radius,
                      p.radius, p.size_sphere));
  require(p.far >= p.size_sphere,
          fmt::format("a largest edge length of at least that at the sphere, {:g}, found {:g}", p.size_sphere, p.far));
  require(p.far <= 0.6 * p.side,
          fmt::format("a largest edge length up to 0.6 of the outer cylinder's radius, found {:g}", p.far));
  require(p.growth >= 0.05 && p.growth <= 0.8, fmt::format("growth between 0.05 and 0.8, found {:g}", p.growth));

  Combination result;
  std::vector<geometry::DescribedSurface> surfaces{
      described_sphere("sphere", whole(Vec3{}), digits(p.radius)), described_plane("inflow", 0, -p.inflow),
      described_plane("outflow", 0, p.outflow),
      described_cylinder("side", whole(Vec3{}), whole(Vec3{1, 0, 0}), digits(p.side)),
      described_plane("symmetry_1", 2, 0)};
  result.region = "+sphere & +inflow & -outflow & -side & +symmetry_1";
  const double angle = 2 * std::numbers::pi / p.parts;
  if (p.parts > 2) {
    const double across = p.parts == 4 ? 0 : -std::cos(angle);
    const Vec3 normal{0, std::sin(angle), across};
    surfaces.push_back(described_plane("symmetry_2", whole(Vec3{}),
                                       {normal, fmt::format("[0.0, {:.17g}, {:.17g}]", normal.y, normal.z)}));
    result.region += " & +symmetry_2";
  }
  result.surfaces = std::make_shared<const geometry::SurfaceSet>(geometry::set_of(surfaces, "supersonic-sphere"));
  // z = r sin(angle) where y = r cos(angle): the sector starts at y > 0
  const double min_y = p.parts == 2 || p.parts == 3 ? -p.side : 0;
  result.low = {-p.inflow, min_y, 0};
  result.high = {p.outflow, p.side, p.parts > 4 ? p.side * std::sin(angle) : p.side};
  result.length_unit = "m";
  result.far = p.far;
  result.growth = p.growth;
  result.near = {{"sphere", p.size_sphere}};
  return result;
}

}  // namespace pamr::meshing
