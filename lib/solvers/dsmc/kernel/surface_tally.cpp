// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/surface_tally.hpp"

namespace pamr::dsmc {

void SurfaceTally::Sums::add(const Sums& other) {
  hits += other.hits;
  for (std::size_t i = 0; i < 3; ++i) momentum[i] += other.momentum[i];
  energy += other.energy;
}

void SurfaceTally::set_units(double mass, double speed) {
  momentum_unit = mass * speed * 0x1p-30;
  energy_unit = mass * speed * speed * 0x1p-30;
}

}  // namespace pamr::dsmc
