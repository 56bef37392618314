// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solvers/poisson_boltzmann/fem/fem_domain.hpp"

namespace pamr::poisson_boltzmann {

/// The mirrors that cut a body or a plane: how much of it is in the mesh.
struct Mirrors {
  double factor = 1;            ///< full body over meshed part
  bool cut[3]{};                ///< the mirror normal to this axis cuts it: that component of a force vanishes
  double level[3]{};            ///< where that mirror lies on its axis
  bool between[3]{};            ///< two mirrors normal to this axis cut it: it has no end, its image the opposite force
  std::uint64_t patches = 0;    ///< the patches of these mirrors, bit p for patch p
  std::uint64_t neighbors = 0;  ///< all patches that share nodes with it, mirrors too

  bool vanishes(std::size_t axis) const { return cut[axis] || between[axis]; }
  geometry::Vec3 complete(geometry::Vec3 force) const {
    return {vanishes(0) ? 0 : factor * force.x, vanishes(1) ? 0 : factor * force.y, vanishes(2) ? 0 : factor * force.z};
  }
  /// The same for a torque about a point on the mirrors: only the component normal to the one mirror is left.
  geometry::Vec3 complete_torque(geometry::Vec3 torque) const;
};

/// For each set of patches of the mesh (bit p for patch p) the mirrors that share nodes with it. A mirror is a patch
/// with condition symmetry that is flat and normal to an axis. Two mirrors of the same direction do not count: between
/// them a body has no end. Collective: two reductions.
std::vector<Mirrors> find_mirrors(const par::Comm& comm, const Domain& domain, const Case& input,
                                  std::span<const std::uint64_t> sets);
/// The same for each patch alone.
std::vector<Mirrors> find_mirrors(const par::Comm& comm, const Domain& domain, const Case& input);

}  // namespace pamr::poisson_boltzmann
