// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include "pamr/geometry/cad/cad_edge.hpp"
#include "pamr/geometry/triangulated/triangle_tree.hpp"

namespace pamr::geometry {

/// The nearest point of a face.
struct CadFoot {
  Vec3 point;
  Uv uv;  ///< of a point of the surface at or next to it
  double distance = 0;
};

/// A face of a CAD shape: the part of a surface within its borders. The curves of the borders belong to it, also where
/// they lie off the surface by the tolerance of the edge. Immutable.
class CadFace {
 public:
  /// `edges` are those of the shape and must outlive the face. Throws `Error` for a face without samples.
  CadFace(CadFaceData data, std::span<const CadEdge> edges, double size);

  const CadFaceData& data() const { return data_; }
  /// Nearest point. Cost: a query of a tree and a closed form or some Newton steps; near a border or a pole twice that.
  CadFoot project(Vec3 point) const;
  /// Unit normal at the parameters, out of the body.
  Vec3 normal(Uv uv) const;
  /// Lower bound of the distance; infinite where that is more than `limit`.
  double distance_at_least(Vec3 point, double limit = std::numeric_limits<double>::infinity()) const;
  /// How far its triangles may lie off it.
  double deflection() const { return deflection_; }
  /// Largest distance of its borders from its surface, by edge, at some points of each.
  double gap(int border) const;
  const std::vector<Vec3>& points() const { return points_; }

 private:
  struct BorderFoot {
    int border = -1;  ///< -1 with a distance: a pole
    CadEdgeFoot foot{{}, 0, std::numeric_limits<double>::infinity()};
  };
  /// A side of the parameters that is one point, of a surface without a closed form.
  struct Pole {
    Vec3 point;
    bool fixes_u = false;         ///< the side has one u, else one v
    double side = 0, inside = 0;  ///< that u or v, and the one of the opposite side
    double reach = 0;             ///< length of the triangles there
    bool is_closed = false;       ///< the face goes all the way around it
  };
  void find_poles();
  bool is_at(const Pole& pole, Uv uv) const;
  Uv beside(const Pole& pole, double along, double inwards) const;
  Uv start_at(const Pole& pole, Vec3 point) const;
  Uv at_weights(const std::array<int, 3>& triangle, const std::array<double, 3>& weight) const;
  CadFoot project_from(Vec3 point, Uv start, int triangle) const;
  CadFoot project_from_samples(Vec3 point, CadFoot best) const;
  /// The point of a flat triangle, and its parameters.
  Vec3 flat_point(const TriangleTree::Hit& hit) const;
  Uv seed(const TriangleTree::Hit& hit) const;
  Uv foot(Vec3 point, Uv start) const;
  Uv in_period(Uv uv) const;
  BorderFoot nearest_border(Vec3 point) const;
  bool is_inside(Uv uv, Vec3 on_surface, const BorderFoot& nearest) const;
  /// Direction into the face at a point of a border, in the surface.
  Vec3 inward(const CadBorder& border, double t, Vec3 surface_normal) const;
  Vec3 cross_normal(Uv uv) const;

  CadFaceData data_;
  std::span<const CadEdge> edges_;
  std::vector<Vec3> points_;  ///< of the samples
  std::optional<TriangleTree> triangles_, borders_;
  std::vector<Pole> poles_;
  std::vector<double> clearance_;  ///< distance of a triangle's middle from the borders
  struct Chord {
    int border = 0;
    double begin = 0, end = 0;
  };
  std::vector<Chord> chords_;  ///< of the tree of borders
  double deflection_ = 0, size_ = 0;
};

}  // namespace pamr::geometry
