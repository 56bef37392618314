// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/kernel/collide.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"
#include "solvers/dsmc/sampling/cell_samples.hpp"

namespace pamr::dsmc {

/// The averaged flow, one entry per own cell. In an empty cell mean free path, collision time and Knudsen number are
/// 1e30 and everything else is 0.
struct CellFlow {
  std::vector<double> density;         ///< 1/m3
  std::vector<double> mass_density;    ///< kg/m3
  std::vector<double> velocity;        ///< m/s, three components per cell
  std::vector<double> t_tr, t_rot, t;  ///< K: translational, rotational, of all together
  std::vector<double> t_vib;           ///< K, vibrational; empty: nothing vibrates
  std::vector<double> mach;
  std::vector<double> collision_time;         ///< s
  std::vector<double> mean_free_path;         ///< in the mesh's length unit
  std::vector<double> knudsen;                ///< mean free path over the cube root of the cell's volume
  std::vector<double> particles;              ///< mean number
  std::vector<double> density_error;          ///< 1/m3, standard error of `density` from blocks; 0 with fewer than two
  std::vector<double> collision_probability;  ///< of a particle in a step
  std::vector<double> separation;             ///< of collision partners over the mean free path
  std::vector<double> scale;  ///< mesh's length unit: n / |grad n| (`density_scale`); empty: not computed
  std::vector<std::vector<double>> species_density;  ///< 1/m3, by species
};

/// Averages of what has been sampled; `unit`: meters in the mesh's length unit. Local. O(cells x species).
CellFlow average_cells(const GasDomain& domain, const Gas& gas, const CellSamples& samples,
                       const std::vector<CellCollisions>& collisions, double unit);

/// The flow under the names and units that it has in files (docs/tools/pamr-dsmc.md), in their order there; densities
/// of species only if there are several. Local.
std::vector<mesh::CellField> to_fields(CellFlow flow, const Gas& gas);

}  // namespace pamr::dsmc
