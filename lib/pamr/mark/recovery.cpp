// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mark/recovery.hpp"

#include <algorithm>

#include "pamr/mesh/tet.hpp"

namespace pamr::mark {

using geometry::Vec3;

Vec3 linear_gradient(const geometry::TetPoints& p, const std::array<double, 4>& value, double volume) {
  std::array<std::size_t, 4> order{0, 1, 2, 3};
  std::sort(order.begin(), order.end(), [&](auto i, auto j) { return geometry::lexicographically_less(p[i], p[j]); });
  Vec3 sum;
  for (const auto i : order) {
    auto corner = mesh::tet::face_to_corner[i];  // its outward normal points away from corner i
    std::array<Vec3, 3> q;
    for (std::size_t k = 0; k < 3; ++k) q[k] = p[at(corner[k])];
    // Turn the face so that it begins with its first corner by coordinates: the same bits whatever the numbering.
    std::rotate(q.begin(), std::min_element(q.begin(), q.end(), geometry::lexicographically_less), q.end());
    sum = sum + (value[i] - value[order[0]]) * cross(q[1] - q[0], q[2] - q[0]);
  }
  return (-1.0 / (6.0 * volume)) * sum;
}

double integral_of_product(double volume, const std::array<Vec3, 4>& a, const std::array<Vec3, 4>& b) {
  Vec3 total_a, total_b;
  double products = 0;
  for (std::size_t k = 0; k < 4; ++k) {
    total_a = total_a + a[k];
    total_b = total_b + b[k];
    products += dot(a[k], b[k]);
  }
  // Integral of the product of two corner functions: V/20, V/10 of one with itself.
  return volume / 20.0 * (products + dot(total_a, total_b));
}

}  // namespace pamr::mark
