// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "pamr/geometry/cad/cad_face.hpp"

namespace pamr::geometry {

/// A CAD shape that answers for nearest points: its faces, numbered from 0 in the order of the file, and the edges that
/// they share. Immutable; shared by all surfaces that are made of its faces.
class CadModel {
 public:
  /// Throws `Error` for a shape without faces, and for one whose edges are off its faces by more than 1e-3 of its size.
  explicit CadModel(CadData data);

  const std::vector<CadFace>& faces() const { return faces_; }
  const std::vector<CadEdge>& edges() const { return edges_; }
  /// The faces at an edge, ascending.
  const std::vector<int>& faces_of(int edge) const { return faces_of_edge_[static_cast<std::size_t>(edge)]; }
  /// Diagonal of the box about the faces, and the largest coordinate.
  double size() const { return size_; }
  double magnitude() const { return magnitude_; }
  int n_solids() const { return n_solids_; }
  const std::string& unit_of_file() const { return unit_of_file_; }
  const CadOrigin& origin() const { return origin_; }
  /// The largest tolerance of an edge: what the shape says, or how far it was found to be off its faces.
  double largest_tolerance() const;
  /// Edges around one face only: the shape is open there, or its faces are not sewn.
  int n_open_edges() const;
  /// Faces within `tolerance` of the point, ascending.
  std::vector<int> faces_near(Vec3 point, double tolerance) const;

 private:
  std::vector<CadEdge> edges_;
  std::vector<CadFace> faces_;
  std::vector<std::vector<int>> faces_of_edge_;
  double size_ = 0, magnitude_ = 0;
  int n_solids_ = 0;
  std::string unit_of_file_;
  CadOrigin origin_;

 public:
  CadModel(const CadModel&) = delete;  // faces refer to edges
  CadModel& operator=(const CadModel&) = delete;
  CadModel(CadModel&&) = delete;
  CadModel& operator=(CadModel&&) = delete;
  ~CadModel() = default;
};

}  // namespace pamr::geometry
