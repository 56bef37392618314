// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "solvers/poisson_boltzmann/fem/problem.hpp"

namespace pamr::poisson_boltzmann {

/// The twenty functions of third order of a cell: those of its ten nodes, then those of `CubicPoint`.
inline constexpr std::size_t n_cubic = 20;
template <class T>
using OfCubicCell = std::array<T, n_cubic>;
/// Those of a boundary face: six nodes, the edges 0-1, 1-2 and 2-0, the face.
template <class T>
using OfCubicFace = std::array<T, 10>;

/// What elements of third order have on a domain of second order: one more function on each edge and on each face.
/// Arrays of functions begin with the nodes of the domain; then come the edges, in the order of their middles, and the
/// faces. The function of an edge runs from its end of lower global number to the other.
struct CubicFunctions {
  NodeMap all;
  std::vector<OfCubicCell<LocalId>> cell_to_function;
  std::vector<std::uint8_t> cell_flips;                ///< bit e: the edge e of the cell runs against its function
  std::vector<OfCubicFace<LocalId>> face_to_function;  ///< of `Domain::faces`
  std::vector<std::uint8_t> face_flips;

  /// Coefficients as a cell sees them: with the signs of its edges.
  OfCubicCell<double> values(std::size_t cell, std::span<const double> coefficient) const;
  double sign(std::size_t cell, std::size_t k) const {
    return k >= 10 && k < 16 && (cell_flips[cell] >> (k - 10) & 1U) != 0 ? -1 : 1;
  }
  double face_sign(std::size_t face, std::size_t k) const {
    return k >= 6 && k < 9 && (face_flips[face] >> (k - 6) & 1U) != 0 ? -1 : 1;
  }
  /// The functions of a face at a point of `face_points()`, with the signs of its edges.
  OfCubicFace<double> face_values(std::size_t face, std::size_t point) const;
  /// With these functions the value of what has these coefficients.
  double on_face(std::size_t face, const OfCubicFace<double>& shape, std::span<const double> coefficient) const;
};
/// Collective: two reductions, and one exchange.
CubicFunctions number_cubic(const par::Comm& comm, const Domain& domain);

/// Where u is given, and what it has there beyond its values at the nodes: coefficients of all functions, 0 at nodes.
struct CubicConditions {
  std::vector<std::uint8_t> fixed;
  std::vector<double> value;
};
/// Collective: one exchange.
CubicConditions cubic_conditions(const par::Comm& comm, const Problem& problem, const CubicFunctions& functions,
                                 std::span<const double> u);

/// The functions of a cell at a point of it, and their gradients, as the cell sees them.
struct CubicAt {
  PlacedPoint placed;
  OfCubicCell<double> value{};
  OfCubicCell<geometry::Vec3> gradient{};
};
/// `value`: the functions of second order at the point.
CubicAt cubic_at(const PlacedPoint& placed, const OfCellNodes<double>& value, const CubicPoint& cubic);
geometry::Vec3 gradient_of(const CubicAt& here, const OfCubicCell<double>& value);

}  // namespace pamr::poisson_boltzmann
