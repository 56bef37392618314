// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <vector>

#include "pamr/geometry/axis.hpp"

namespace pamr::geometry {

/// Center of a circular arc and its sense of travel with x to the right and r upwards. Without a sense the shorter arc
/// is meant; a half circle needs one.
struct ProfileArc {
  Meridian center;
  std::optional<bool> clockwise;
};

/// A line segment, or a circular arc, of a meridian half plane.
struct ProfilePiece {
  Meridian from, to;
  std::optional<ProfileArc> arc;
};

/// A chain of segments and arcs in the half plane r >= 0: the meridian of a surface of revolution. Its normal points
/// to the left of the direction of travel: away from the axis where x grows.
class Profile {
 public:
  /// Each piece starts where the one before it ends, arcs have the same radius at both ends, both to 1e-9 of the size;
  /// what is left of these gaps is closed (a start moves onto the end before it, a center onto the perpendicular
  /// bisector). Throws `Error` that names the piece (from 1) otherwise, and for no or zero-length pieces, numbers that
  /// are not finite, and pieces that reach below the axis.
  explicit Profile(const std::vector<ProfilePiece>& pieces);

  /// Nearest point over all pieces, and the unit normal of its piece there; the first piece among equals, the start of
  /// an arc for its center.
  struct Nearest {
    Meridian point, normal;
    double distance = 0;
  };
  Nearest nearest(Meridian at) const;

  /// Nearest point at which two pieces join off the axis; the first among equals, nothing for a single piece.
  std::optional<Meridian> nearest_joint(Meridian at) const;

  /// Corners off the axis, where pieces join at more than 5 degrees, part the profile into smooth runs, numbered from
  /// 0.
  bool has_corners() const { return !corners_.empty(); }
  /// Number of the run that holds the nearest point.
  int run_at(Meridian at) const;
  struct Corner {
    Meridian point;
    std::array<int, 2> run{};  ///< before and after it
  };
  /// There must be one.
  const Corner& nearest_corner(Meridian at) const;

  /// Area of the surface of a full turn. Exact per piece: frustums, and zones of tori and spheres.
  double area() const;
  /// Integral of pi r^2 dx over the profile: the volume inside when the profile starts and ends on the axis or is
  /// closed; positive when the normal points out of it.
  double volume() const;
  /// Bound of the absolute coordinates of the profile and its centers, and of its radii.
  double magnitude() const;
  /// True for a single piece that turns into a full disc.
  bool is_disc() const;

 private:
  struct Piece {
    Meridian from, to;
    bool is_arc = false;
    Meridian tangent;                         // unit; of a segment
    Meridian center, from_center, to_center;  // unit vectors from the center to the ends; of an arc
    double length = 0;                        // of a segment; radius of an arc
    double sense = 0, sweep = 0;              // +1 counter-clockwise, -1 clockwise; angle travelled, in (0, 2 pi)
  };
  static Piece make_piece(const ProfilePiece& given);
  static void make_arc(const ProfileArc& given, Piece& piece);
  static bool spans(const Piece& arc, Meridian from_center);
  static Nearest nearest_on(const Piece& piece, Meridian at);
  std::size_t nearest_piece(Meridian at) const;
  void find_corners();

  std::vector<Piece> pieces_;
  std::vector<int> run_;  // of each piece
  std::vector<Corner> corners_;
};

}  // namespace pamr::geometry
