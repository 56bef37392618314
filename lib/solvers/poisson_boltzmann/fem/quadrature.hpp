// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>

#include "solvers/poisson_boltzmann/problem/source_term.hpp"

namespace pamr::poisson_boltzmann {

/// A point of a tetrahedron by its four barycentric coordinates; the weights of all points add up to 1.
struct QuadraturePoint {
  std::array<double, 4> weight_of_corner;
  double weight;
};

/// Four points on a tetrahedron, exact for polynomials of degree 2. Source: A. H. Stroud, "Approximate Calculation of
/// Multiple Integrals", 1971.
constexpr std::array<QuadraturePoint, 4> gauss_points_degree_2() {
  constexpr double a = 0.58541019662496845446, b = 0.13819660112501051518;  // (5 + 3 sqrt 5)/20, (5 - sqrt 5)/20
  return {{{{a, b, b, b}, 0.25}, {{b, a, b, b}, 0.25}, {{b, b, a, b}, 0.25}, {{b, b, b, a}, 0.25}}};
}
inline constexpr auto gauss_points = gauss_points_degree_2();

/// A point of a triangle; the weights add up to 1.
struct TrianglePoint {
  std::array<double, 3> weight_of_corner;
  double weight;
};

/// Exact for polynomials of degree 4, six points. Source: D. A. Dunavant, Int. J. Numer. Meth. Engng 21 (1985).
constexpr std::array<TrianglePoint, 6> triangle_points_degree_4() {
  constexpr double a = 0.108103018168070, b = 0.445948490915965, w = 0.223381589678011;
  constexpr double c = 0.816847572980459, d = 0.091576213509771, v = 0.109951743655322;
  return {{{{a, b, b}, w}, {{b, a, b}, w}, {{b, b, a}, w}, {{c, d, d}, v}, {{d, c, d}, v}, {{d, d, c}, v}}};
}
inline constexpr auto triangle_points = triangle_points_degree_4();

}  // namespace pamr::poisson_boltzmann
