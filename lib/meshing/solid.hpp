// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <memory>
#include <span>
#include <string>
#include <vector>

#include "meshing/region.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/surface_set.hpp"
#include "pamr/geometry/vec3.hpp"

namespace pamr::meshing {

/// A part of space bounded by surfaces, or several that share no point: those on whose sides a region says which are in
/// it.
struct Solid {
  geometry::SharedSurfaces surfaces;
  std::vector<Region> regions;
  geometry::Vec3 low, high;                 ///< a box that holds them
  std::vector<std::string> region_names{};  ///< as messages call them; none for one region without a name

  int n_surfaces() const { return surfaces->size(); }
  const geometry::Surface& surface(int i) const { return *surfaces->surface[static_cast<std::size_t>(i)]; }
  const std::string& name(int i) const { return surfaces->name[static_cast<std::size_t>(i)]; }

  /// A point that lies on the given surfaces to rounding, put on the flat ones among them once more: coordinate planes
  /// then hold it exactly.
  geometry::Vec3 on_planes(std::span<const int> among, geometry::Vec3 p) const;
  /// Distance from surface `i`, negative on the side to which its normal does not point.
  double signed_distance(int i, geometry::Vec3 p) const { return surface(i).signed_distance(p); }
  Sides sides(geometry::Vec3 p) const { return sides_around(p).sides; }
  struct SidesAround {
    Sides sides = 0;
    double radius = 0;  ///< of a ball in which they are the same, where the distances from all surfaces are exact
  };
  SidesAround sides_around(geometry::Vec3 p) const;
  /// The region of these sides, -1: none.
  int region_of(Sides sides) const;
  /// Throws `Error` where two regions contain the sides of a point.
  void require_apart(Sides sides, geometry::Vec3 p) const;
  bool contains(geometry::Vec3 p) const { return region_of(sides(p)) >= 0; }
  /// The regions that surface `i` divides at a point of it on the given sides of the others, ascending, the second -1
  /// where it bounds the solid; the same twice where it divides nothing.
  std::array<int, 2> regions_beside(int i, Sides sides) const;
  /// True when surface `i` bounds the solid, or one of its regions, at a point of it on the given sides of the others.
  bool divides(int i, Sides sides) const {
    const auto [first, second] = regions_beside(i, sides);
    return first != second;
  }

  /// Where a point lies: in a region, or behind the surface to cross last on the least way in, lengths measured by the
  /// largest distance from any surface crossed: what a `Domain` calls the piece behind which the point lies. The
  /// borders between these parts of the outside meet the solid in its edges and nowhere else.
  struct Place {
    int surface = -1;  ///< -1: the point lies in the region
    int region = -1;   ///< that the point lies in, or that the way in leads to; -1: no way is known
  };
  Place place(geometry::Vec3 p) const;

  geometry::Vec3 center() const { return geometry::midpoint(low, high); }
  double radius() const { return 0.5 * geometry::norm(high - low); }
};

using SurfaceSamples = std::vector<std::vector<geometry::Vec3>>;

/// Points on each surface, near enough to each other to find what is larger than a twelfth of the solid's radius, or a
/// sixth of the surface: nearest points of a grid that fills the solid's box.
SurfaceSamples sample_surfaces(const Solid& solid);

}  // namespace pamr::meshing
