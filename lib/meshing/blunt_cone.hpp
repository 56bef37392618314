// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "meshing/meshing_domain.hpp"

namespace pamr::meshing {

/// Wanted edge lengths, meters. Each holds at its part of the wall and one length around, and grows from there by
/// `growth` per distance up to `far`.
struct BluntConeSizes {
  double far = 10e-3;
  double forebody = 3.4e-3;  ///< nose and cone
  double shoulder = 0.75e-3;
  double base = 3.6e-3;
  double fillet = 1.25e-3;
  double sting = 3.0e-3;
  double growth = 0.6;  ///< no unit

  /// The sizes that make `far` the largest, all others in proportion, but none larger on a curved wall than the
  /// default.
  static BluntConeSizes scaled_to(double far);
};

/// Name and bounds of each of the sizes. The upper bounds of those on arcs keep every wall edge within the smaller
/// radius of curvature there (the defaults within 0.8 of it); the others keep the mesh valid.
struct SizeLimit {
  const char* name;
  double BluntConeSizes::*value;
  double low, high;
};
std::span<const SizeLimit> blunt_cone_size_limits();

/// Where the gas ends, meters. The body has a radius of 25 mm; its sting begins at x = 12.5 mm.
struct BluntConeGeometry {
  double outer_radius = 60e-3;  ///< of the cylinder around the gas, whose front edge is rounded with 30 mm
  double outflow = 60e-3;       ///< x of the plane behind
  friend bool operator==(const BluntConeGeometry&, const BluntConeGeometry&) = default;
};
struct GeometryLimit {
  const char* name;
  double BluntConeGeometry::*value;
  double low, high;
};
std::span<const GeometryLimit> blunt_cone_geometry_limits();

/// Half of the gas around the 70-degree blunt cone with its sting, meters: x along the axis, nose tip in the origin,
/// y >= 0. Patches forebody, base, sting, inflow, outflow, symmetry. Local. Throws `Error` for values out of range.
Domain blunt_cone(const BluntConeSizes& sizes, const BluntConeGeometry& geometry = {});

}  // namespace pamr::meshing
