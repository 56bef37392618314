// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <string>
#include <utility>
#include <vector>

#include "meshing/meshing_domain.hpp"
#include "meshing/region.hpp"

namespace pamr::meshing {

/// The regions that the solids of a CAD assembly are, of which a combination has no other surface.
struct AssemblyRegions {
  std::vector<std::string> name;            ///< none: one region without a name
  std::vector<int> of_solid;                ///< of each solid of the shape
  std::vector<std::array<int, 2>> of_face;  ///< at the sides of each face of the shape; the second -1: outside
};

/// One of several regions, or a part of one: parts of one name are one region.
struct NamedRegion {
  std::string name;
  std::string sides;  ///< see `Region`
  std::string at;     ///< where it is described (file:line:column)
};

/// A region bounded by surfaces, or several, as a case file describes them.
struct Combination {
  geometry::SharedSurfaces surfaces;  ///< each becomes a patch of its name, triangulated ones several (see `Pieces`)
  std::string region;                 ///< see `Region`; empty where there are parts
  std::vector<NamedRegion> parts;     ///< of several regions
  geometry::Vec3 low, high;           ///< a box that holds the region, in units of the mesh as all lengths here
  std::string length_unit;
  double far = 0;     ///< largest wanted edge length
  double growth = 0;  ///< of the wanted edge length per distance, no unit; under 1
  /// Edges between two surfaces that run about along each other are at most so many times as long as the gap there;
  /// 0: no bound.
  double gap_factor = 0;
  /// Edges on curved CAD faces are at most so many times as long as the smaller radius of curvature, but not asked to
  /// be shorter than `least` (0: a tenth of `far`).
  double curvature = 0.5;
  double least = 0;
  /// Edges in thin parts of CAD shapes are at most so many times as long as these are thick; 0: no bound.
  double thickness_factor = 0;
  /// Wanted edge lengths up to one such length from a surface; they grow from there.
  std::vector<std::pair<std::string, double>> near;

  AssemblyRegions regions;

  bool has_cad() const;  ///< whether one of the surfaces is on a CAD shape
};

/// The regions of a combination. Throws `Error` that begins with `where`, or the place of its part, for text that is no
/// region, and for a surface that no region names. Local.
std::vector<Region> regions_of(const Combination& combination, const std::string& where);

/// The domain that it describes. Local, deterministic. Throws `Error` that begins with `where` for regions that are
/// none or overlap, a region that leaves its box, and edges as `trace_feature_curves` refuses them.
Domain combine(const Combination& combination, const std::string& where);

}  // namespace pamr::meshing
