// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solvers/poisson_boltzmann/fem/cubic_functions.hpp"
#include "solvers/poisson_boltzmann/fem/site_walls.hpp"

namespace pamr::poisson_boltzmann {

/// As `at_site_points` of second order, with the functions of third order of the face: calls `use(const SitePoint&,
/// const OfCubicFace<double>&)`, the functions with the signs of their edges. Local.
template <class Use>
void at_cubic_sites(const Problem& problem, std::span<const double> u, const CubicFunctions& functions,
                    const Use& use) {
  at_site_points(problem, u, [&](const SitePoint& point) {
    auto shape = cubic_face_values(face_points()[point.index]);
    for (std::size_t k = 6; k < 9; ++k) shape[k] *= functions.face_sign(point.face, k);
    use(point, shape);
  });
}

/// The value at a point of a face of what has these coefficients of all functions.
inline double on_face(const OfCubicFace<LocalId>& function, const OfCubicFace<double>& shape,
                      std::span<const double> coefficient) {
  double sum = 0;
  for (std::size_t k = 0; k < shape.size(); ++k) sum += shape[k] * coefficient[at(function[k])];
  return sum;
}

}  // namespace pamr::poisson_boltzmann
