// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/mesh_case.hpp"

#include <fmt/format.h>

#include "meshing/charged_spheres.hpp"
#include "meshing/sphere_in_box.hpp"
#include "meshing/supersonic_sphere.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/listed.hpp"

namespace pamr::meshing {

MeshCase case_of_shape(const std::string& shape, double size) {
  MeshCase result;
  result.shape = result.where = shape;
  if (shape == "blunt-cone") {
    if (size != 0) result.blunt_cone = BluntConeSizes::scaled_to(size);
  } else if (shape == "sphere-in-box") {
    if (size != 0) result.box_size = size;
  } else if (shape == "charged-spheres") {
    ChargedSpheres spheres;
    if (size != 0) spheres.far = size;
    result.combination = charged_spheres(spheres);
  } else if (shape == "supersonic-sphere") {
    SupersonicSphere sphere;
    sphere.far = size;
    result.combination = supersonic_sphere(sphere);
  } else {
    throw Error(
        fmt::format("expected --shape kuhn-cube, blunt-cone, sphere-in-box, charged-spheres or supersonic-sphere (more "
                    "with a case file), found \"{}\"",
                    shape));
  }
  return result;
}

Domain domain_of(const MeshCase& mesh_case) {
  if (mesh_case.shape == "blunt-cone") return blunt_cone(mesh_case.blunt_cone, mesh_case.cone_geometry);
  if (mesh_case.shape == "sphere-in-box") return sphere_in_box(mesh_case.box_size);
  return combine(mesh_case.combination, mesh_case.where);
}

std::string describe(const MeshCase& mesh_case) {
  auto line = fmt::format("pamr-mesh: shape {}, seed {}, sizes", mesh_case.shape, mesh_case.seed);
  if (mesh_case.shape == "sphere-in-box") return line + fmt::format(" edge {}", mesh_case.box_size);
  if (mesh_case.shape == "blunt-cone") {
    for (const auto& limit : blunt_cone_size_limits())
      line += fmt::format(" {} {}", limit.name, mesh_case.blunt_cone.*limit.value);
    for (const auto& limit : blunt_cone_geometry_limits())
      if (const double value = mesh_case.cone_geometry.*limit.value; value != BluntConeGeometry{}.*limit.value)
        line += fmt::format(", {} {}", limit.name, value);
    return line;
  }
  const auto& c = mesh_case.combination;
  line += fmt::format(" far {} growth {}", c.far, c.growth);
  if (c.has_cad()) line += fmt::format(" curvature {} least {}", c.curvature, c.least);
  if (c.thickness_factor > 0) line += fmt::format(" thickness {}", c.thickness_factor);
  if (!c.regions.name.empty()) line += fmt::format(" regions {}", listed(c.regions.name, {.most = all_items}));
  for (const auto& [name, size] : c.near) line += fmt::format(" {} {}", name, size);
  const auto regions = listed(c.parts, {.most = all_items}, [](const auto& p) { return p.name + " = " + p.sides; });
  return line + fmt::format(", bounds {} {} {} to {} {} {}, {} {}", c.low.x, c.low.y, c.low.z, c.high.x, c.high.y,
                            c.high.z, c.parts.empty() ? "region" : "regions", c.parts.empty() ? c.region : regions);
}

}  // namespace pamr::meshing
