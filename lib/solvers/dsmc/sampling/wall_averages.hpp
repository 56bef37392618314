// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pamr/par/comm.hpp"
#include "solvers/dsmc/kernel/boundary.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"
#include "solvers/dsmc/kernel/surface_tally.hpp"

namespace pamr::dsmc {

/// Sums over a boundary face since averaging began, and what their errors follow from.
struct FaceTotals {
  SurfaceTally::Sums sums;
  double heat_squares = 0;      ///< sum over the blocks of the energy squared, in units of energy_unit squared
  double pressure_squares = 0;  ///< the same of the momentum along the normal, in units of momentum_unit squared

  /// Ends a block with these sums, on a face with this normal.
  void add_block(const SurfaceTally::Sums& block, Vec3 normal);
};

/// Averages on one wall face.
struct FaceRow {
  GlobalId cell = 0;
  std::int64_t slot = 0, patch = 0;
  std::array<Vec3, 3> corner{};  ///< m
  double area = 0;
  double pressure = 0, pressure_error = 0;  ///< Pa
  Vec3 shear;                               ///< Pa, the stress along the face
  double heat = 0, heat_error = 0;          ///< W/m2
  double hits = 0;                          ///< per step
};

/// What turns sums into averages.
struct WallScale {
  double momentum_unit = 1, energy_unit = 1;  ///< of `SurfaceTally`
  double fnum_per_time = 1;                   ///< real molecules per particle and second
  double n_steps = 1, n_blocks = 0;
};

/// Averages on the wall faces of this rank, in the order of cells and slots. Errors are standard errors from the
/// blocks. `patch`: of the mesh; `totals`: one for each boundary face. Local.
std::vector<FaceRow> wall_averages(const GasDomain& domain, std::span<const BoundaryCondition> patch,
                                   std::span<const FaceTotals> totals, const WallScale& scale);

/// Writes the faces of all ranks as a VTK XML file of triangles (`.vtu`) with the cell fields p, p_stderr, tau, q,
/// q_stderr, hits, patch and area. `unit`: meters in the mesh's length unit, in which the points are written;
/// `n_global_cells` of the mesh. Collective. Throws `Error` when the file cannot be written.
void write_walls(const par::Comm& comm, const std::string& file, const std::vector<FaceRow>& faces, double unit,
                 GlobalId n_global_cells);

}  // namespace pamr::dsmc
