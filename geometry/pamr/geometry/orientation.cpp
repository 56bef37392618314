// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/orientation.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>

#include "pamr/base/contract.hpp"

namespace pamr::geometry {

int exact_orientation(Vec3 a, Vec3 b, Vec3 c, Vec3 d) {
  PAMR_EXPECTS(is_finite(a) && is_finite(b) && is_finite(c) && is_finite(d));
  using Point = CGAL::Exact_predicates_inexact_constructions_kernel::Point_3;
  const CGAL::Orientation sign =
      CGAL::orientation(Point(a.x, a.y, a.z), Point(b.x, b.y, b.z), Point(c.x, c.y, c.z), Point(d.x, d.y, d.z));
  return static_cast<int>(sign);
}

}  // namespace pamr::geometry
