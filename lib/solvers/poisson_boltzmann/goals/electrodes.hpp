// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "solvers/poisson_boltzmann/fem/mirrors.hpp"

namespace pamr::poisson_boltzmann {

/// What forces, torques and charges are given for: a patch that holds a charge or a potential, or several as one body.
struct Electrode {
  std::string name;
  std::uint64_t patches = 0;  ///< bit p for patch p of the mesh
  Mirrors mirrors;
  geometry::Vec3 center;  ///< of the torque: on its mirrors, else as the case states it or the centroid of the surface
  /// The sphere that it is, where the case says so.
  const Sphere* sphere = nullptr;

  bool has(int patch) const { return (patches >> static_cast<unsigned>(patch) & 1U) != 0; }
};

/// Those patches in the order of the mesh, then the bodies of several patches in the order of the case. Collective: two
/// reductions. Refers to the spheres of `input`.
std::vector<Electrode> find_electrodes(const par::Comm& comm, const Domain& domain, const Case& input);

}  // namespace pamr::poisson_boltzmann
