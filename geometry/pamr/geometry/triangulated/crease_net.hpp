// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <optional>
#include <utility>
#include <vector>

#include "pamr/geometry/triangulated/crease.hpp"
#include "pamr/geometry/triangulated/triangle_tree.hpp"
#include "pamr/geometry/triangulated/triangulated_curve.hpp"
#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::geometry {

/// Creases one after another between two corners, or around a closed curve: smooth in itself.
struct CreaseLine {
  std::vector<Vec3> polyline;  ///< points of the curve, finely; the first one again at the end when it is closed
  std::array<int, 2> piece{};  ///< of the triangles on its two sides, equal where it ends inside a piece; -1: none
  bool is_closed() const { return polyline.front() == polyline.back(); }
};

/// The creases of a triangulated surface as curves. Local, thread-safe, the same bits for the same point.
class CreaseNet {
 public:
  /// All creases, or, unless `only_piece` is negative, those round that piece. O(n log n).
  CreaseNet(const Triangulation& surface, const Features& features, int only_piece);

  bool is_empty() const { return edges_.empty(); }
  std::size_t n_edges() const { return edges_.size(); }
  const std::vector<CreaseLine>& lines() const { return lines_; }

  /// Nearest point of all creases; there must be some.
  Vec3 nearest(Vec3 point) const;
  /// The crease (by its number in the features) with the nearest point, and the parameter there; nothing where none is
  /// within `distance`, and there may be one that is little farther.
  struct Hit {
    int crease = -1;
    double u = 0;
  };
  std::optional<Hit> nearest_within(Vec3 point, double distance) const;
  /// Nearest point of one line.
  Vec3 nearest_on_line(std::size_t line, Vec3 point) const;
  /// Whether both ends of the chord lie on a crease, to 1e-6 of the chord and 1.5 times what the crease bulges from its
  /// own chord there: nodes of a mesh may lie on the flat triangles. Never where the net has no crease.
  bool is_near(Vec3 a, Vec3 b) const;
  /// The point of the crease for the middle of the chord from a to b, where both lie on one line next to each other.
  /// A line between two pieces must have `sides` (in either order) on its two sides and less way between a and b than
  /// twice the chord; one with the same piece on both sides less than 1.3 times, and a and b on it to 1e-6 of the
  /// chord. Does not depend on the order of a and b.
  std::optional<Vec3> between(Vec3 a, Vec3 b, std::array<int, 2> sides) const;

 private:
  struct Edge {
    CurvedEdge curve;
    std::array<int, 2> end{};  // points, renumbered
    std::array<Vec3, 2> tangent{};
    std::array<int, 2> piece{-1, -1};
    std::size_t line = 0;
    double start = 0, length = 0;  // along the line, chords
    bool runs_along = true;        // from its first point to its second
    double bulge = 0;              // distance of the curve from its chord
    int number = 0;                // in the features
  };
  struct Line {
    std::vector<int> edges;  // in order
    double length = 0;
    std::optional<TriangleTree> tree;
  };
  struct Place {
    Vec3 point;
    double way = 0;  // along the line
    double bulge = 0;
  };
  std::optional<Vec3> between_on(std::size_t line, Vec3 a, Vec3 b, std::array<int, 2> sides) const;
  std::pair<int, Foot> nearest_edge(Vec3 point, const TriangleTree::Hit& chord) const;
  bool is_smooth_at(int end, int one, int other) const;
  void chain();
  void sample(Line& line);
  Place place_on(const Line& line, Vec3 point) const;

  std::vector<Edge> edges_;
  std::vector<std::array<Vec3, 2>> chord_;
  std::vector<std::vector<int>> edges_at_end_;  // by renumbered point
  std::optional<TriangleTree> tree_;
  double largest_bulge_ = 0;
  std::vector<Line> line_;
  std::vector<CreaseLine> lines_;
};

}  // namespace pamr::geometry
