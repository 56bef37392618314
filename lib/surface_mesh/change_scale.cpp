// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/change_scale.hpp"

#include <array>

#include "pamr/base/error.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/geometry/parameters.hpp"

namespace pamr::surface_mesh {

namespace {

struct Unit {
  std::string_view name;
  double meters;
};
constexpr std::array<Unit, 9> units{{{"nm", 1e-9},
                                     {"um", 1e-6},
                                     {"mm", 1e-3},
                                     {"cm", 1e-2},
                                     {"dm", 1e-1},
                                     {"m", 1},
                                     {"km", 1e3},
                                     {"in", 0.0254},
                                     {"ft", 0.3048}}};

}  // namespace

void scale(geometry::Triangulation& surface, double factor) {
  for (auto& p : surface.points) p = factor * p;
}

void translate(geometry::Triangulation& surface, geometry::Vec3 by) {
  const auto checked = geometry::checked_point(by, "--by");
  for (auto& p : surface.points) p += checked;
}

double meters_of(std::string_view unit) {
  for (const auto& known : units)
    if (known.name == unit) return known.meters;
  throw Error("expected a unit of length (" + known_units() + "), found \"" + std::string(unit) + "\"");
}

std::string known_units() { return listed(units, {}, &Unit::name); }

}  // namespace pamr::surface_mesh
