// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "pamr/geometry/vec3.hpp"

namespace pamr::dsmc {

using geometry::Vec3;

/// A uniform gas in equilibrium, far away or at the start; its rotation and vibration may have
/// temperatures of their own.
struct Stream {
  std::string name;
  double density = 0;      ///< molecules per m3
  double temperature = 0;  ///< K
  double rotational_temperature = 0;
  Vec3 velocity;                 ///< m/s
  std::vector<double> fraction;  ///< of the species; sum 1
  double vibrational_temperature = 0;
};

}  // namespace pamr::dsmc
