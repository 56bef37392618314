// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "solvers/poisson_boltzmann/fem_domain.hpp"

namespace pamr::poisson_boltzmann {

/// The mirrors that cut a body or a plane: how much of it is in the mesh.
struct Mirrors {
  double factor = 1;  ///< full body over meshed part
  bool cut[3]{};      ///< the mirror normal to this axis cuts it: that component of a force vanishes

  geometry::Vec3 complete(geometry::Vec3 force) const {
    return {cut[0] ? 0 : factor * force.x, cut[1] ? 0 : factor * force.y, cut[2] ? 0 : factor * force.z};
  }
};

/// For each patch of the mesh the mirrors that share nodes with it. A mirror is a patch with condition symmetry that is
/// flat and normal to an axis. Two mirrors of the same direction do not count: between them a body has no end.
/// Collective: one reduction.
std::vector<Mirrors> find_mirrors(const par::Comm& comm, const Domain& domain, const Case& input);

}  // namespace pamr::poisson_boltzmann
