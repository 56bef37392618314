// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <functional>
#include <string>
#include <vector>

#include "pamr/geometry/surface_set.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::meshing {

/// Nearest point of an exact curve or surface.
using Nearest = std::function<geometry::Vec3(geometry::Vec3)>;

/// A smooth part of the boundary: all of a patch, or one side of it where the patch has sharp edges.
struct Piece {
  int patch = 0;
  Nearest nearest;
  /// Where a piece is to be found that no curve touches, or that only curves in one plane touch: some points on it.
  std::vector<geometry::Vec3> start{};
  std::array<int, 2> region{0, -1};  ///< at its sides, ascending; the second -1: it bounds the domain
  bool is_inside() const { return region[1] >= 0; }
};

/// A part of the domain whose cells are known by a name and a number; parts of one number are one region.
struct DomainRegion {
  std::string name;
  int number = 1;     ///< from 1 on, in the order of the parts
  double volume = 0;  ///< of the solids that it is, where that is known
};

/// A curve that mesh edges must follow: a sharp edge of the domain, or the border between two patches of one smooth
/// surface. `polyline` samples it finely; its ends are corners of the domain and stay as they are.
struct FeatureCurve {
  std::vector<geometry::Vec3> polyline;
  Nearest nearest;
};

/// A part of space to mesh, described without any mesher. Its functions may be called until the last copy is gone.
struct Domain {
  /// `in_region` of the region that the point lies in, or the piece of the boundary behind which it lies: a straight
  /// path from the domain to it, short enough, crosses that piece.
  std::function<int(geometry::Vec3)> label;
  static constexpr int in_region(int region) { return -1 - region; }
  static constexpr int region_of(int label) { return -1 - label; }  ///< negative outside
  static constexpr int inside = -1;                                 ///< `in_region(0)`: of a domain of one region
  /// A ball whose points are all in one region, -1: outside.
  struct Ball {
    int region = -1;
    double radius = 0;  ///< 0: only the center is known
    geometry::Vec3 center{};
    bool holds(geometry::Vec3 point) const { return geometry::norm(point - center) < radius; }
  };
  /// A ball that contains the point or is centered at it. Not set where distances to the boundary are not known.
  std::function<Ball(geometry::Vec3)> around;
  /// Empty: the domain is one region without a name.
  std::vector<DomainRegion> regions;
  int n_regions() const { return std::max(1, static_cast<int>(regions.size())); }
  /// Wanted edge length at a point; changes by less than the distance does.
  std::function<double(geometry::Vec3)> size;
  std::vector<Piece> pieces;
  std::vector<FeatureCurve> curves;
  std::vector<geometry::Vec3>
      tips;  ///< corners of the boundary off the curves (the apex of a cone): nodes are put there
  /// The pieces' points to start from come before the balls along curves: these span no space where all curves lie in
  /// one plane, and every piece has such points then.
  bool points_first = false;
  std::vector<mesh::Patch> patches;
  std::vector<std::string> notes;  ///< for the user: patches that could not have the names of their files
  geometry::SharedSurfaces surfaces = geometry::no_surfaces();  ///< that the patches lie on
  /// The thinnest place at which edges are wanted that are longer than the body is thick there; 0: none is known.
  struct Thin {
    geometry::Vec3 point;
    double thickness = 0, size = 0;
  } thin;
  double boundary_nodes = 0;  ///< that the sizes ask for at least, where that is known
  double volume = 0;          ///< of the body that it is, where that is known
  std::string length_unit;
  geometry::Vec3 center;  ///< of a ball that holds the domain
  double radius = 0;      ///< of that ball
};

}  // namespace pamr::meshing
