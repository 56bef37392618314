// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace pamr::geometry {

template <std::size_t N>
using SquareMatrix = std::array<std::array<double, N>, N>;

/// When an entry beside the diagonal counts as zero, and when to give up.
struct JacobiRule {
  int max_sweeps = 50;
  double absolute = 1e-300;  ///< 0: exact zeros alone, which then stay as they are
  double relative = 1e-18;   ///< of the sum of the two entries on the diagonal
};

/// sqrt(1 + x^2), also for an x whose square overflows.
struct SafeRoot {
  double operator()(double x) const { return std::hypot(1.0, x); }
};
/// The same, faster, for entries that differ by less than 150 orders of magnitude.
struct PlainRoot {
  double operator()(double x) const { return std::sqrt(x * x + 1); }
};

/// Turns a symmetric matrix until it is diagonal, so that its diagonal holds the eigenvalues; returns the eigenvectors
/// as columns, in the same order. A diagonal matrix is left as it is: surfaces along the coordinate axes stay exact.
/// Cost: O(N^3) a sweep, about five sweeps. Source: C. G. J. Jacobi, 1846.
template <std::size_t N, class Root = SafeRoot>
SquareMatrix<N> diagonalize(SquareMatrix<N>& m, JacobiRule rule = {}, Root root = {}) {
  SquareMatrix<N> axis{};
  for (std::size_t i = 0; i < N; ++i) axis[i][i] = 1;
  bool is_diagonal = false;
  for (int sweep = 0; sweep < rule.max_sweeps && !is_diagonal; ++sweep) {
    is_diagonal = true;
    for (std::size_t p = 0; p < N; ++p)
      for (std::size_t q = p + 1; q < N; ++q) {
        const double size = std::abs(m[p][q]);
        if (size <= rule.absolute || size < rule.relative * (std::abs(m[p][p]) + std::abs(m[q][q]))) {
          if (size > 0 || rule.absolute > 0) m[p][q] = m[q][p] = 0;  // both: rounding may have left one
          continue;
        }
        is_diagonal = false;
        const double theta = (m[q][q] - m[p][p]) / (2 * m[p][q]);
        const double tangent = std::copysign(1.0, theta) / (std::abs(theta) + root(theta));
        const double cosine = 1 / root(tangent), sine = tangent * cosine;
        const auto turn = [cosine, sine](double& a, double& b) {
          const double was = a;
          a = cosine * was - sine * b;
          b = sine * was + cosine * b;
        };
        for (std::size_t k = 0; k < N; ++k) turn(m[k][p], m[k][q]);
        for (std::size_t k = 0; k < N; ++k) {
          turn(m[p][k], m[q][k]);
          turn(axis[k][p], axis[k][q]);
        }
      }
  }
  return axis;
}

}  // namespace pamr::geometry
