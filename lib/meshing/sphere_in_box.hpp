// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "meshing/meshing_domain.hpp"

namespace pamr::meshing {

struct BoxSizeLimits {
  double low, high;
};
inline constexpr BoxSizeLimits box_size_limits{0.02, 0.6};

/// The cube |x|, |y|, |z| <= 2 with the unit ball cut out, edges of length `size` everywhere. Patches `box` (its six
/// flat sides, which lie on no surface) and `sphere`. Local. Throws `Error` for a size out of range.
Domain sphere_in_box(double size);

}  // namespace pamr::meshing
