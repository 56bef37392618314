// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "solvers/dsmc/run/run.hpp"

namespace pamr::dsmc {

/// Averages on one face of the walls.
struct FaceRow {
  GlobalId cell = 0;
  std::int64_t slot = 0, patch = 0;
  std::array<Vec3, 3> corner{};  ///< m
  double area = 0;
  double pressure = 0, pressure_error = 0;  ///< Pa
  Vec3 shear;                               ///< Pa, the stress along the face
  double heat = 0, heat_error = 0;          ///< W/m2
  double hits = 0;                          ///< a step
};

/// The walls' faces with what the run has averaged on them, on rank 0 in the order of cells and slots; the other ranks
/// get none. Errors are standard errors from the blocks. Collective.
std::vector<FaceRow> wall_faces(const par::Comm& comm, const Run& run);

/// The faces as a VTK XML file of triangles (`.vtu`): cell fields p, p_stderr, tau, q, q_stderr, hits, patch, area.
/// Lengths in the mesh's unit. Local.
std::string to_vtu(const std::vector<FaceRow>& faces, double unit);

}  // namespace pamr::dsmc
