// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "solvers/dsmc/kernel/particles.hpp"

namespace pamr::dsmc {

/// A particle with time left to fly from its position.
struct Flight {
  Particle particle;
  double time = 0;                  ///< s, from `particle.position`
  double passed = 0;                ///< s, part of `time` that is known to be used up
  double dt_from = 0;               ///< s, time step of the cell that it left, while between ranks
  double begun = 0;                 ///< s, from `particle.position`: when it came out of a periodic patch
  std::uint32_t events = 0;         ///< wall reflections in this step
  std::uint32_t excluded_face = 0;  ///< bit of the wall face of the cell that it just left
};

}  // namespace pamr::dsmc
