// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::dsmc {

using geometry::Vec3;

/// A plane, a disk or a parallelogram in the gas through which molecules are counted. Meters.
struct FluxPlane {
  std::string name;
  Vec3 point;         ///< on the plane; of a disk the center, of a parallelogram a corner
  Vec3 normal;        ///< unit
  double radius = 0;  ///< of a disk; 0: no disk
  Vec3 along,
      across;  ///< edges of a parallelogram, in the plane; 0: no parallelogram

  /// 1 where the line from `a` to `b` passes it along the normal, -1 against it, else 0. Lines that begin where others
  /// end pass the entire plane as often as their chain changes sides. Local.
  int crossing(Vec3 a, Vec3 b) const;

 private:
  bool is_ahead(Vec3 p) const { return dot(normal, p - point) >= 0; }
  bool holds(Vec3 p) const;
};

/// The planes of a computation, and where they are.
struct FluxPlanes {
  std::vector<FluxPlane> plane;
  std::vector<std::uint8_t> cuts_cell;  ///< of each own cell: whether it is touched by one of them, bounds apart
};

/// Throws the same `Error` on every rank for a plane that touches no cell. `unit`: of the mesh, m. Collective.
FluxPlanes place_planes(const par::Comm& comm, const mesh::DistMesh& mesh, double unit, std::vector<FluxPlane> planes);

}  // namespace pamr::dsmc
