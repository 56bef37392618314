// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/scaled_surfaces.hpp"

#include <fmt/format.h>

#include <string>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/toml_table.hpp"
#include "pamr/geometry/described_surface.hpp"

namespace pamr::geometry {

namespace {

DescribedSurface scaled(const TomlTable& t, double factor) {
  const auto name = t.text("name"), kind = t.text("kind");
  const auto point = [&](const char* key) { return shortest(factor * t.point<Vec3>(key)); };
  const auto direction = [&](const char* key) { return shortest(t.point<Vec3>(key)); };
  const auto length = [&](const char* key) { return shortest(factor * t.number(key)); };
  if (kind == "plane") return described_plane(name, point("point"), direction("normal"));
  if (kind == "sphere") return described_sphere(name, point("center"), length("radius"));
  if (kind == "cylinder") return described_cylinder(name, point("point"), direction("axis"), length("radius"));
  if (kind == "cone") return described_cone(name, point("apex"), direction("axis"), shortest(t.number("half_angle")));
  if (kind == "torus")
    return described_torus(name, point("center"), direction("axis"), length("major_radius"), length("minor_radius"));
  throw Error(
      fmt::format("expected surfaces that can be scaled (plane, sphere, cylinder, cone or torus), found surface \"{}\" "
                  "of kind {}: scale what the mesh was made of, or convert to a format without surfaces",
                  name, kind));
}

}  // namespace

SurfaceSet scaled(const SurfaceSet& set, double factor) {
  const auto root = parse_toml(set.toml, "surfaces");
  std::vector<DescribedSurface> surfaces;
  for (const auto& table : root.list("surface")) surfaces.push_back(scaled(table, factor));
  return set_of(surfaces, "surfaces");
}

}  // namespace pamr::geometry
