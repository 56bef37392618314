// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "pamr/geometry/crease.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/geometry/triangulated_curve.hpp"
#include "pamr/geometry/triangulated_tree.hpp"

namespace pamr::geometry {

/// A smooth surface through the points of a triangulation, sharp at its creases: cubic triangles from normals of fitted
/// quadrics, continuous; planar pieces stay planar. The normal points to the side from which the triangles are seen
/// counter-clockwise. The nearest point is found from the nearest flat triangle by going downhill over the curved ones.
class Triangulated final : public Surface {
 public:
  struct Options {
    double feature_angle = 40;      ///< degrees between the normals of two triangles, more is a crease; in (0, 180)
    bool open_allowed = false;      ///< the surface may end
    std::optional<Vec3> near = {};  ///< take only the piece between creases that is nearest to this point
  };
  /// Throws `Error` unless the triangulation is valid (`require_valid`) and the options are in range. O(n log n).
  Triangulated(const Triangulation& surface, const Options& options);

  Vec3 project(Vec3 point) const override;
  Vec3 normal(Vec3 point) const override;
  /// Nearest point of the creases, and of the ends of an open surface; the nearest point where there are none.
  Vec3 project_to_seam(Vec3 point) const override;
  /// True for a planar piece taken alone.
  bool is_flat() const override { return is_flat_; }
  double magnitude() const override { return magnitude_; }

  /// Pieces between creases of the whole triangulation.
  std::size_t n_patches() const { return features_.is_planar.size(); }
  std::size_t n_creases() const { return edges_.size(); }

 private:
  struct Place {
    Foot foot;
    int triangle = -1;
  };
  Place nearest(Vec3 point) const;
  /// A nearer point in a triangle next to where `here` touches the border of its own; false when there is none.
  bool go_on(Vec3 point, Place& here) const;
  bool try_triangle(Vec3 point, int triangle, double u, double v, Place& best) const;
  Vec3 onto_plane(int triangle, Vec3 point) const;
  void build_triangles(const Triangulation& surface);
  void build_edges(const Triangulation& surface, int only_patch);

  Features features_;
  std::vector<CurvedTriangle> curved_;
  std::vector<int> triangle_of_tree_;
  std::optional<TriangleTree> tree_;
  std::vector<CurvedEdge> edges_;
  std::vector<std::array<int, 2>> edge_ends_;   // points, renumbered
  std::vector<std::vector<int>> edges_at_end_;  // by point
  std::optional<TriangleTree> edge_tree_;
  bool stays_in_patch_ = false, is_flat_ = false;
  double magnitude_ = 0;
};

/// Reads the files of all surfaces of kind `triangulation` in TOML text (see `surfaces_from_toml`), each named as its
/// surface; a relative `file` counts from the folder of `where`. Throws `Error` with the line. Local.
std::vector<Triangulation> triangulations_of_toml(std::string_view text, std::string_view where);

}  // namespace pamr::geometry
