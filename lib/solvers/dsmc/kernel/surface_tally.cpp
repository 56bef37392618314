// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/surface_tally.hpp"

#include <algorithm>

namespace pamr::dsmc {

void SurfaceTally::Sums::add(const Sums& other) {
  hits += other.hits;
  for (std::size_t i = 0; i < 3; ++i) momentum[i] += other.momentum[i];
  energy += other.energy;
}

bool SurfaceTally::Sums::is_nearly_full() const {
  constexpr auto limit = std::int64_t{1} << 61U;
  const auto is_far = [](std::int64_t value) { return value > limit || value < -limit; };
  return is_far(hits) || is_far(energy) || std::any_of(momentum.begin(), momentum.end(), is_far);
}

bool SurfaceTally::is_nearly_full() const {
  return std::any_of(face.begin(), face.end(), [](const Sums& sums) { return sums.is_nearly_full(); });
}

void SurfaceTally::set_units(double mass, double speed) {
  momentum_unit = mass * speed * 0x1p-30;
  energy_unit = mass * speed * speed * 0x1p-30;
}

}  // namespace pamr::dsmc
