// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/change_scale.hpp"

#include <fmt/format.h>

#include <array>
#include <cstddef>
#include <utility>
#include <vector>

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

/// Puts each point where `place` says; throws `Error` where that is out of range or gives corners of a triangle one
/// place.
template <class Place>
void move_points(geometry::Triangulation& surface, const char* what, const Place& place) {
  auto moved = surface.points;
  for (auto& p : moved) {
    p = place(p);
    if (!geometry::is_in_range(p))
      throw Error(fmt::format("{}: expected coordinates that stay below {}, found ({:g}, {:g}, {:g})", what,
                              geometry::max_coordinate_text, p.x, p.y, p.z));
  }
  const auto at_one_place = [](const std::vector<geometry::Vec3>& points, const std::array<int, 3>& t) {
    const auto at = [&](int corner) { return points[static_cast<std::size_t>(t[static_cast<std::size_t>(corner)])]; };
    return at(0) == at(1) || at(1) == at(2) || at(2) == at(0);
  };
  for (const auto& triangle : surface.triangles)
    if (at_one_place(moved, triangle) && !at_one_place(surface.points, triangle))
      throw Error(
          fmt::format("{}: expected numbers that keep the points apart, found some that put corners of a "
                      "triangle at one place (16 digits are not enough)",
                      what));
  surface.points = std::move(moved);
}

}  // namespace

void scale(geometry::Triangulation& surface, double factor) {
  move_points(surface, "scale", [factor](geometry::Vec3 p) { return factor * p; });
}

void translate(geometry::Triangulation& surface, geometry::Vec3 by) {
  move_points(surface, "--by", [by](geometry::Vec3 p) { return p + by; });
}

double meters_of(std::string_view unit) {
  for (const auto& known : units)
    if (known.name == unit) return known.meters;
  throw Error("expected a unit of length (" + known_units() + "), found \"" + std::string(unit) + "\"");
}

std::string known_units() { return listed(units, {}, &Unit::name); }

}  // namespace pamr::surface_mesh
