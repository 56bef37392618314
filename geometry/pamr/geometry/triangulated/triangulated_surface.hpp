// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/triangulated/crease.hpp"
#include "pamr/geometry/triangulated/crease_net.hpp"
#include "pamr/geometry/triangulated/named_parts.hpp"
#include "pamr/geometry/triangulated/triangle_tree.hpp"
#include "pamr/geometry/triangulated/triangulated_curve.hpp"

namespace pamr::geometry {

/// A smooth surface through the points of a triangulation, sharp at its creases: cubic triangles from normals of fitted
/// quadrics, continuous; planar pieces stay planar. The normal points to the side from which the triangles are seen
/// counter-clockwise. The nearest point is found from the nearest flat triangle by going downhill over the curved ones.
class Triangulated final : public Surface, public Creases {
 public:
  struct Options {
    CreaseOptions crease{};
    Exact<bool> open_allowed = false;  ///< the surface may end
    std::optional<Vec3> near = {};     ///< take only the piece between creases that is nearest to this point
    std::shared_ptr<const NamedParts> parts = {};  ///< of the triangles; null: none. Where they meet are creases
  };
  /// Throws `Error` unless the triangulation is valid (`require_valid`) and the options are in range. O(n log n).
  Triangulated(std::shared_ptr<const Triangulation> surface, const Options& options);
  Triangulated(Triangulation surface, const Options& options)
      : Triangulated(std::make_shared<const Triangulation>(std::move(surface)), options) {}

  Vec3 project(Vec3 point) const override;
  Vec3 normal(Vec3 point) const override;
  /// Beyond a crease or a corner the sign is that of the mean normal there, by angle at a corner.
  /// Source: J. A. Baerentzen, H. Aanaes, Signed distance computation using the angle weighted pseudonormal, 2005.
  double signed_distance(Vec3 point) const override;
  /// Nearest point of the creases, and of the ends of an open surface; the nearest point where there are none.
  Vec3 project_to_seam(Vec3 point) const override;
  const Creases* creases() const override { return creases_->is_empty() ? nullptr : this; }
  std::optional<Vec3> crease_between(Vec3 a, Vec3 b, Vec3 c, Vec3 d) const override;
  /// Measured on the triangle nearest to the point, at its middle and at the middles of its sides.
  double facet_deviation(Vec3 point) const override;
  /// True for a planar piece taken alone.
  bool is_flat() const override { return is_flat_; }
  double magnitude() const override { return shape_->magnitude; }

  /// Pieces between creases of the whole triangulation.
  std::size_t n_patches() const { return shape_->features.is_planar.size(); }
  /// Name of the part that a piece belongs to; empty where the parts have no names.
  std::string part_of(int piece) const;
  /// Whether the parts of its file divide it, and their names, of the whole alone.
  bool has_parts() const { return parts_ != nullptr; }
  std::vector<std::string> part_names() const;
  std::size_t n_creases() const { return creases_->n_edges(); }
  int piece_at(Vec3 point) const override {
    return shape_->features.patch[static_cast<std::size_t>(nearest(point).triangle)];
  }
  /// One piece taken alone; it shares the data of the whole.
  std::unique_ptr<const Triangulated> piece(int number) const;
  /// The creases as curves: all of them, or, of a piece taken alone, those around it and in it.
  const CreaseNet& crease_net() const { return *creases_; }
  /// True for one piece taken alone, by `near` or by `piece`.
  bool is_one_piece() const { return stays_in_patch_; }
  /// Calls `use(piece, middle)` for every triangle, with the middle of the flat one.
  template <class Use>
  void for_each_triangle(Use&& use) const {
    for (const int t : triangle_of_tree_) {
      const auto& corner = shape_->corner[static_cast<std::size_t>(t)];
      const auto point = [&](std::size_t k) { return flat_->points[static_cast<std::size_t>(corner[k])]; };
      use(shape_->features.patch[static_cast<std::size_t>(t)], (1.0 / 3) * (point(0) + point(1) + point(2)));
    }
  }

 private:
  struct Shape {
    Features features;
    std::vector<CurvedTriangle> curved;
    std::vector<std::array<int, 3>> corner;  // n_triangles x 3 points
    std::vector<Vec3> pseudonormal;          // by point, not of unit length
    double magnitude = 0;
  };
  struct CreaseSide {
    int triangle = -1, edge = 0;
    bool runs_along = true;  // the edge of the triangle, in the sense of the crease
  };
  struct Place {
    Foot foot;
    int triangle = -1;
  };
  Triangulated(std::shared_ptr<const Shape> shape, std::shared_ptr<const Triangulation> flat, int only_piece);
  static std::shared_ptr<Shape> make_shape(const Triangulation& surface, const CreaseOptions& options);
  static void curve_triangles(const Triangulation& surface, Shape& shape);
  static void find_pseudonormals(const Triangulation& surface, Shape& shape);
  /// The whole for -1.
  void take_piece(int only_piece);

  Place nearest(Vec3 point) const;
  /// A nearer point at a crease: beside one the nearest flat triangle may lie in another piece, and no walk leads over.
  bool go_to_crease(Vec3 point, Place& here) const;
  /// A nearer point in a triangle next to where `here` touches the border of its own; false when there is none.
  bool go_on(Vec3 point, Place& here) const;
  bool try_triangle(Vec3 point, int triangle, double u, double v, Place& best) const;
  Vec3 onto_plane(int triangle, Vec3 point) const;
  Vec3 foot_of(const Place& here, Vec3 point) const;
  Vec3 unit_normal(int triangle, double u, double v) const;
  /// The normal by which the side of a point is decided where its nearest point lies.
  Vec3 outward(const Place& here) const;

  std::shared_ptr<const Shape> shape_;
  std::shared_ptr<const Triangulation> flat_;
  std::shared_ptr<const NamedParts> parts_;  // null: none, and of a piece taken alone
  std::vector<int> triangle_of_tree_;
  std::optional<TriangleTree> tree_;
  std::optional<CreaseNet> creases_;
  std::vector<CreaseSide> side_of_crease_;  // one of its triangles, of this piece
  bool stays_in_patch_ = false, is_flat_ = false;
};

}  // namespace pamr::geometry
