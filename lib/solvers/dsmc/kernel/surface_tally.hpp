// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "pamr/geometry/vec3.hpp"

namespace pamr::dsmc {

using geometry::Vec3;

/// Momentum and energy that particles have given to each boundary face, in fixed point, so that the sums depend neither
/// on the order of the hits nor on the number of ranks. One unit is 2^-30 of a typical hit; a face overflows after 10^9
/// typical hits, which `is_nearly_full` tells long before.
struct SurfaceTally {
  struct Sums {
    std::int64_t hits = 0;
    std::array<std::int64_t, 3> momentum{};
    std::int64_t energy = 0;

    void add(const Sums& other);
    /// Whether a number is beyond a quarter of what fits. Local.
    bool is_nearly_full() const;
  };

  double momentum_unit = 1;  ///< kg m/s
  double energy_unit = 1;    ///< J
  std::vector<Sums> face;    ///< one for each boundary face

  /// Sets the units for molecules of this mass at this speed.
  void set_units(double mass, double speed);
  /// Whether the sums of any face are.
  bool is_nearly_full() const;
  void add(std::size_t at, Vec3 momentum, double energy) {
    auto& sums = face[at];
    ++sums.hits;
    sums.momentum[0] += fixed(momentum.x / momentum_unit);
    sums.momentum[1] += fixed(momentum.y / momentum_unit);
    sums.momentum[2] += fixed(momentum.z / momentum_unit);
    sums.energy += fixed(energy / energy_unit);
  }

  /// To the nearest integer.
  static std::int64_t fixed(double value) { return static_cast<std::int64_t>(value + (value < 0 ? -0.5 : 0.5)); }
};

}  // namespace pamr::dsmc
