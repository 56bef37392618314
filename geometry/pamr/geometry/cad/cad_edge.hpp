// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/geometry/box.hpp"
#include "pamr/geometry/cad/cad_data.hpp"

namespace pamr::geometry {

/// The nearest point of an edge.
struct CadEdgeFoot {
  Vec3 point;
  double t = 0, squared_distance = 0;
};

/// An edge of a CAD shape: its curve between its ends, and samples on it from which searches start. Immutable.
class CadEdge {
 public:
  /// `sagitta`: how far the chords between samples may lie off the curve; `size`: of the shape, to which rounding is
  /// relative.
  CadEdge(CadEdgeData data, double sagitta, double size);

  const CadEdgeData& data() const { return data_; }
  /// Ascending parameters, from one end to the other.
  const std::vector<double>& samples() const { return samples_; }
  const std::vector<Vec3>& points() const { return points_; }
  double length() const { return length_; }
  double tolerance() const { return data_.tolerance; }
  /// Enlarges the tolerance to what was measured.
  void widen(double tolerance) { data_.tolerance = tolerance > data_.tolerance ? tolerance : data_.tolerance; }
  /// Moves an end (0: the first) to where the others of its vertex are: files state the ends of edges that meet to
  /// their tolerance only, and the corner of a mesh is one node.
  void join(std::size_t end, Vec3 corner);

  /// Lower bound of the distance: that of the box about the edge.
  double distance_at_least(Vec3 point) const;
  Vec3 point(double t) const;
  /// Direction of the curve, of unit length; that of a chord where the derivative vanishes.
  Vec3 tangent(double t) const;
  /// Nearest point by Newton's method from parameter t, never farther than the start and the ends.
  CadEdgeFoot nearest(Vec3 to, double t) const;
  /// The same from the nearest sample.
  CadEdgeFoot nearest(Vec3 to) const;

 private:
  struct Sample {
    double t = 0;
    Vec3 point;
  };
  Sample sample(double t) const { return {t, data_.curve->at(t).point}; }
  void add_samples(const Sample& from, const Sample& to, double sagitta, int depth);

  CadEdgeData data_;
  std::vector<double> samples_;
  std::vector<Vec3> points_;  ///< the first and the last are the ends
  Box box_;
  double length_ = 0, size_ = 0;
};

}  // namespace pamr::geometry
