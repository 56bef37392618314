// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <span>

#include "pamr/geometry/vec3.hpp"

namespace pamr::poisson_boltzmann {

/// Ten values of a cell of second order: the corners, then the middles of the edges as in `mesh/tet.hpp`.
template <class T>
using OfCellNodes = std::array<T, 10>;
/// Six values of a boundary face: corners 0, 1, 2, then the middles of 0-1, 1-2 and 2-0.
template <class T>
using OfFaceNodes = std::array<T, 6>;

/// The shape functions of second order at a point of the reference tetrahedron, with their derivatives along the edges
/// from corner 0.
struct CellPoint {
  OfCellNodes<double> value{};
  OfCellNodes<geometry::Vec3> derivative{};
  double weight = 0;  ///< of the quadrature rule; those of all points add up to 1
  std::array<double, 4> barycentric{};
};
CellPoint cell_point(const std::array<double, 4>& barycentric, double weight = 0);

/// 14 points, exact for polynomials of degree 5. Source: N. J. Walkington, "Quadrature on simplices of arbitrary
/// dimension", Carnegie Mellon University, 2000.
const std::array<CellPoint, 14>& cell_points();
/// The ten nodes.
const std::array<CellPoint, 10>& cell_nodes_as_points();

/// A point of a cell of second order in space.
struct PlacedPoint {
  geometry::Vec3 position;
  double jacobian = 0;                   ///< determinant: six times the volume of a straight cell
  std::array<geometry::Vec3, 3> dual{};  ///< gradients of the reference coordinates
  OfCellNodes<geometry::Vec3> gradient{};
};
PlacedPoint place(const OfCellNodes<geometry::Vec3>& node, const CellPoint& point);

/// What third order adds to second, at a point of the reference tetrahedron: functions that are 0 at the ten nodes, six
/// of the edges, l_a l_b (l_a - l_b), and four of the faces, the product of the l of their corners, face i opposite
/// corner i.
struct CubicPoint {
  OfCellNodes<double> value{};
  OfCellNodes<geometry::Vec3> derivative{};
};
CubicPoint cubic_point(const std::array<double, 4>& barycentric);
/// At `cell_points()`.
const std::array<CubicPoint, 14>& cubic_points();
/// Their gradients at a point in space.
OfCellNodes<geometry::Vec3> gradients(const PlacedPoint& placed, const CubicPoint& point);

/// The shape functions of a face at a point, with their derivatives along the edges from corner 0.
struct FacePoint {
  std::array<double, 3> barycentric{};
  OfFaceNodes<double> value{};
  OfFaceNodes<double> along_1{}, along_2{};
  double weight = 0;  ///< those of all points add up to 1
};
/// 12 points, exact for polynomials of degree 6. Source: D. A. Dunavant, Int. J. Numer. Meth. Engng 21 (1985).
const std::array<FacePoint, 12>& face_points();
FacePoint face_point(const std::array<double, 3>& barycentric, double weight = 0);

/// A point of a curved face in space.
struct PlacedFacePoint {
  geometry::Vec3 position;
  geometry::Vec3 normal;  ///< unit; seen from its tip the corners run counter-clockwise
  double area = 0;        ///< that the point stands for
  /// Where the far field and a force are taken at: the point; of first order the middle of the face.
  geometry::Vec3 middle;
};
PlacedFacePoint place(const OfFaceNodes<geometry::Vec3>& node, const FacePoint& point);

/// The value at a point of what has these values at the nodes.
template <std::size_t N>
double interpolated(const std::array<double, N>& shape, const std::array<double, N>& value) {
  double sum = 0;
  for (std::size_t k = 0; k < N; ++k) sum += shape[k] * value[k];
  return sum;
}

inline geometry::Vec3 gradient_of(const PlacedPoint& point, const OfCellNodes<double>& value) {
  geometry::Vec3 sum;
  for (std::size_t k = 0; k < 10; ++k) sum += value[k] * point.gradient[k];
  return sum;
}

}  // namespace pamr::poisson_boltzmann
