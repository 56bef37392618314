// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/kernel/random.hpp"

namespace pamr::dsmc {

/// Levels of a molecule in equilibrium at `t` (K): one random word for each mode. 0 where nothing vibrates. Local.
std::uint32_t thermal_levels(const Vibration& vibration, double t, Random& random);

/// The level of a mode after an exchange with a relative motion; `total`: energy of both over k theta. Level v has a
/// probability in proportion to (total - v)^exponent; at most `highest`. Local.
/// Source: F. Bergemann, I. D. Boyd, "New discrete vibrational energy model for the direct simulation Monte Carlo
/// method", Progress in Astronautics and Aeronautics 158 (1994); G. A. Bird 1994, section 5.6.
std::uint32_t draw_level(double total, double exponent, std::uint32_t highest, Random& random);

/// Energy of a molecule's rotation and vibration, J.
inline double internal_energy(const Species& species, double rotation, std::uint32_t levels) {
  if (species.vibration.mode.empty()) return rotation;
  return rotation + boltzmann * vibrational_energy(species.vibration, levels);
}

}  // namespace pamr::dsmc
