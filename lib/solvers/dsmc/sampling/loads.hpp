// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "pamr/par/comm.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"
#include "solvers/dsmc/run/flow_case.hpp"
#include "solvers/dsmc/sampling/surface_tally.hpp"

namespace pamr::dsmc {

/// A mean with its standard error.
struct Estimate {
  double value = 0, error = 0;
};
/// Mean and standard error of independent numbers; the error is 0 for fewer than two.
Estimate estimate(const std::vector<double>& values);

/// What the gas does to a patch or a body: N, N m, W.
struct Load {
  Vec3 force, moment;
  double heat = 0;
  Load& operator+=(const Load& other);
};

/// Loads of every patch from the sums of `n_steps` steps, without the reference's multiplier. The sums are exact or
/// independent of the order of the faces: the same bits on any number of ranks. Collective.
std::vector<Load> patch_loads(const par::Comm& comm, const Domain& domain, const SurfaceTally& units,
                              const std::vector<SurfaceTally::Sums>& face, double molecules_per_time,
                              std::int64_t n_steps, Vec3 point, std::size_t n_patches);

/// A stress and a heat flux on a face, as functions of its outward normal (out of the gas, into the body).
using SurfaceLaw = std::function<std::pair<Vec3, double>(Vec3 normal)>;
/// Loads of every patch under a law. Collective.
std::vector<Load> integrate_law(const par::Comm& comm, const Domain& domain, const SurfaceLaw& law, Vec3 point,
                                std::size_t n_patches);

/// Dimensionless loads: drag, lift and pitching moment on rho V^2/2 x area (x length), heat on rho V^3/2 x area.
struct Coefficients {
  double drag = 0, lift = 0, moment = 0, heat = 0;
};

/// Scales loads for a free stream at rest or in motion; a gas at rest counts with its most probable speed.
class Scale {
 public:
  Scale(const Gas& gas, const Stream& stream, const Reference& reference);

  Coefficients coefficients(const Load& load) const;
  double dynamic_pressure() const { return pressure_; }
  double speed() const { return speed_; }
  Vec3 drag_direction() const { return drag_; }

 private:
  Reference reference_;
  Vec3 drag_, lift_;
  double pressure_ = 0, speed_ = 0;
};

/// Whether the forces on each patch belong to the reference body.
std::vector<bool> reference_patches(const Reference& reference, const std::vector<mesh::Patch>& patches,
                                    const std::vector<BoundaryCondition>& conditions);
Load sum_of(const std::vector<Load>& patch, const std::vector<bool>& wanted);

/// Free-molecular flow with full diffuse accommodation at the walls' temperature, and the Newtonian limit: bounds for a
/// convex body without shadows.
SurfaceLaw free_molecular_law(const Gas& gas, const Stream& stream, double wall_temperature);
SurfaceLaw newtonian_law(const Gas& gas, const Stream& stream);

}  // namespace pamr::dsmc
