// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/described_surface.hpp"

#include <fmt/format.h>

#include "pamr/geometry/cone.hpp"
#include "pamr/geometry/cylinder.hpp"
#include "pamr/geometry/parameters.hpp"
#include "pamr/geometry/plane.hpp"
#include "pamr/geometry/revolution.hpp"
#include "pamr/geometry/sphere.hpp"
#include "pamr/geometry/surface_toml.hpp"
#include "pamr/geometry/torus.hpp"

namespace pamr::geometry {

namespace {

std::string head(const std::string& name, const char* kind) {
  return fmt::format("[[surface]]\nname = {}\nkind = \"{}\"\n", toml_text(name), kind);
}

std::string pair(Meridian p) { return fmt::format("[{:.17g}, {:.17g}]", p.x, p.r); }

std::string inline_table(const ProfilePiece& piece) {
  const auto ends = fmt::format("from = {}, to = {}", pair(piece.from), pair(piece.to));
  if (!piece.arc) return fmt::format("{{{}}}", ends);
  std::string arc = "center = " + pair(piece.arc->center);
  if (piece.arc->clockwise) arc += fmt::format(", clockwise = {}", *piece.arc->clockwise);
  return fmt::format("{{{}, {}}}", ends, arc);
}

}  // namespace

Written<double> digits(double value) { return {value, fmt::format("{:.17g}", value)}; }
Written<Vec3> digits(Vec3 v) { return {v, fmt::format("[{:.17g}, {:.17g}, {:.17g}]", v.x, v.y, v.z)}; }
Written<double> shortest(double value) { return {value + 0.0, decimal(value)}; }
Written<Vec3> shortest(Vec3 v) { return {v + Vec3{}, decimal(v)}; }
Written<double> whole(double value) { return {value, fmt::format("{:.1f}", value)}; }
Written<Vec3> whole(Vec3 v) { return {v, fmt::format("[{:.1f}, {:.1f}, {:.1f}]", v.x, v.y, v.z)}; }

DescribedSurface described_plane(const std::string& name, const Written<Vec3>& point, const Written<Vec3>& normal) {
  return {name, std::make_shared<Plane>(point.value, normal.value),
          head(name, "plane") + fmt::format("point = {}\nnormal = {}\n", point.toml, normal.toml)};
}

DescribedSurface described_plane(const std::string& name, Exact<int> axis, double at) {
  const auto along = [axis](double value) {
    return Vec3{axis == 0 ? value : 0.0, axis == 1 ? value : 0.0, axis == 2 ? value : 0.0};
  };
  return described_plane(name, digits(along(at)), digits(along(1)));
}

DescribedSurface described_sphere(const std::string& name, const Written<Vec3>& center, const Written<double>& radius) {
  return {name, std::make_shared<Sphere>(center.value, radius.value),
          head(name, "sphere") + fmt::format("center = {}\nradius = {}\n", center.toml, radius.toml)};
}

DescribedSurface described_cylinder(const std::string& name, const Written<Vec3>& point, const Written<Vec3>& axis,
                                    const Written<double>& radius) {
  return {
      name, std::make_shared<Cylinder>(point.value, axis.value, radius.value),
      head(name, "cylinder") + fmt::format("point = {}\naxis = {}\nradius = {}\n", point.toml, axis.toml, radius.toml)};
}

DescribedSurface described_cone(const std::string& name, const Written<Vec3>& apex, const Written<Vec3>& axis,
                                const Written<double>& half_angle) {
  return {name, std::make_shared<Cone>(apex.value, axis.value, half_angle.value),
          head(name, "cone") +
              fmt::format("apex = {}\naxis = {}\nhalf_angle = {}\n", apex.toml, axis.toml, half_angle.toml)};
}

DescribedSurface described_torus(const std::string& name, const Written<Vec3>& center, const Written<Vec3>& axis,
                                 const Written<double>& major_radius, const Written<double>& minor_radius) {
  return {name, std::make_shared<Torus>(center.value, axis.value, major_radius.value, minor_radius.value),
          head(name, "torus") + fmt::format("center = {}\naxis = {}\nmajor_radius = {}\nminor_radius = {}\n",
                                            center.toml, axis.toml, major_radius.toml, minor_radius.toml)};
}

DescribedSurface described_revolution(const std::string& name, const std::vector<ProfilePiece>& profile) {
  const auto origin = whole(Vec3{}), axis = whole(Vec3{1, 0, 0});
  auto toml = head(name, "revolution") + fmt::format("origin = {}\naxis = {}\nprofile = [\n", origin.toml, axis.toml);
  for (std::size_t i = 0; i < profile.size(); ++i)
    toml += "  " + inline_table(profile[i]) + (i + 1 < profile.size() ? ",\n" : "\n");
  return {name, std::make_shared<Revolution>(origin.value, axis.value, profile), toml + "]\n"};
}

SurfaceSet set_of(std::span<const DescribedSurface> surfaces, const std::string& where) {
  SurfaceSet set;
  for (const auto& one : surfaces) {
    set.add(one.name, where, one.surface);
    set.toml += (set.toml.empty() ? "" : "\n") + one.toml;
  }
  return set;
}

}  // namespace pamr::geometry
