// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "pamr/base/types.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/geometry/vec3.hpp"

/// The map of a cell with bulges, X(l) = sum of l_i P_i + sum over edges ab of 4 l_a l_b B_ab + residual, with
/// barycentric coordinates l, and an energy that is the larger, the worse its shapes.
namespace pamr::curved {

/// Derivatives of a map at a point: dX/dl_a - dX/dl_0 for a = 1, 2, 3; length units.
using JacobianRows = std::array<geometry::Vec3, 3>;

namespace detail {
constexpr std::array<std::array<double, 4>, 20> make_sample_points() {
  std::array<std::array<double, 4>, 20> points{};
  std::size_t n = 0;
  for (int a = 0; a <= 3; ++a)
    for (int b = 0; a + b <= 3; ++b)
      for (int c = 0; a + b + c <= 3; ++c) points[n++] = {a / 3.0, b / 3.0, c / 3.0, (3 - a - b - c) / 3.0};
  return points;
}
}  // namespace detail

/// Where shapes are sampled: barycentric coordinates of the lattice of order 3.
inline constexpr std::array<std::array<double, 4>, 20> sample_points = detail::make_sample_points();

/// The derivatives of a residual at each of `sample_points`, to be added to those of the map.
using SampledRows = std::array<JacobianRows, sample_points.size()>;

/// The `SampledRows` of some cells: 1,440 bytes for each that has any.
struct SampledWalls {
  std::vector<SampledRows> rows;
  std::vector<LocalId> cell_to_rows;  ///< of each cell the place there, -1: it has none; empty: no cell has one

  const SampledRows* of(std::size_t cell) const {
    const auto place = cell_to_rows.empty() ? -1 : cell_to_rows[cell];
    return place < 0 ? nullptr : &rows[static_cast<std::size_t>(place)];
  }
};

/// Bulges of a cell's edges, in the order of mesh/tet.hpp: the displacements of their middles, length units.
using CellBulges = std::array<geometry::Vec3, 6>;

/// Symmetric matrix of 3 x 3: entries 00, 01, 02, 11, 12, 22.
using Symmetric3 = std::array<double, 6>;

/// A cell before its edges bulge, prepared for what follows.
struct StraightCell {
  JacobianRows row;
  double inverse_determinant = 0;  ///< of `row`
  /// The squared size n of a map of rows J against a target is the sum over a, b of metric_ab J_a . J_b, and factor n^3
  /// is 1 at the target. Target 0: the regular tetrahedron of the cell's volume; target 1: the straight cell itself.
  std::array<Symmetric3, 2> metric;
  std::array<double, 2> factor{};
  double mean_ratio = 0;  ///< positive: the cell's own orientation counts as the right one
};

/// Pre: none; without volume the members are not finite, or `mean_ratio` is 0. Local.
StraightCell prepare(const geometry::TetPoints& corner);

/// Distortion eta of a map at a point against a target: 1 over the mean ratio of the Jacobian between the two, with
/// h(d) = (d + sqrt(d^2 + 4 delta^2)) / 2 in place of its determinant d, so that it is finite and falls with growing d
/// for folded maps as well. Energy: sum over sample points and both targets of eta^(3 exponent), without roots.
/// Source: A. Gargallo-Peiro, X. Roca, J. Peraire, J. Sarrate, "Optimization of a regularized distortion measure to
/// generate curved high-order unstructured tetrahedral meshes", Int. J. Numer. Meth. Engng 103 (2015); the
/// regularized determinant is that of V. Garanzha, I. Kaporin (1999) and of J. M. Escobar et al. (2003).
struct Distortion {
  double delta = 0;  ///< in determinants of the straight cell
  int exponent = 1;
};

/// Energy of a cell; `residual` may be null. The same bits for the same arguments; another order of the corners rounds
/// otherwise. Local, about 0.5 us.
double bulge_energy(const StraightCell& cell, const CellBulges& bulge, const SampledRows* residual,
                    const Distortion& distortion);

/// Quadratic model of a cell's energy in the components of its free bulges, edge by edge.
struct BulgeModel {
  double energy = 0;
  CellBulges gradient;  ///< 0 for edges that are not free
  /// Upper triangle, row by row, in the front. Positive definite: the second derivatives, but for those of the
  /// determinant by the bulges, with as much curvature along the determinant as it takes.
  std::array<double, 171> hessian{};
};

/// Entries of the upper triangle of a matrix of n rows, and the place of one of them.
constexpr std::size_t triangle_size(std::size_t n) { return n * (n + 1) / 2; }
constexpr std::size_t triangle_entry(std::size_t n, std::size_t i, std::size_t j) {
  return i * n - i * (i + 1) / 2 + j;
}

/// As `bulge_energy`, up to 4 us. `is_free`: bits of the edges.
BulgeModel bulge_model(const StraightCell& cell, const CellBulges& bulge, const SampledRows* residual,
                       const Distortion& distortion, unsigned is_free = 0x3f);
/// The same by instructions that all processors have.
BulgeModel bulge_model_anywhere(const StraightCell& cell, const CellBulges& bulge, const SampledRows* residual,
                                const Distortion& distortion, unsigned is_free);

/// Smallest mean ratio of the Jacobian at the sample points, against the regular tetrahedron; its sign is that of the
/// determinant relative to the straight cell's. Local.
double smallest_mean_ratio(const StraightCell& cell, const CellBulges& bulge, const SampledRows* residual);

}  // namespace pamr::curved
