// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/gas/stream.hpp"
#include "solvers/dsmc/kernel/boundary.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"
#include "solvers/dsmc/kernel/surface_tally.hpp"

namespace pamr::dsmc {

/// What forces, moments and heat are made dimensionless with. Drag points along the stream, lift along stream x pitch
/// axis, the moment is that about the pitch axis.
struct Reference {
  double area = 1;    ///< m2
  double length = 1;  ///< m
  Vec3 point;         ///< m, about which moments are taken
  Vec3 pitch_axis{0, 1, 0};
  double multiplier = 1;             ///< of loads: 2 if the mesh is one half of a symmetric flow
  std::vector<std::string> patches;  ///< whose loads count; empty: all walls

  /// Whether forces across the stream can be told from the part that is computed: not from less than half of a body,
  /// whose other parts are turned or mirrored across the pitch axis.
  bool gives_lift() const { return multiplier <= 2; }
};

/// Force, moment and heat that the gas gives to a patch or a body: N, N m, W.
struct Load {
  Vec3 force, moment;
  double heat = 0;
  Load& operator+=(const Load& other);
};

/// Sums over some steps of what particles gave to boundary faces. Only references.
struct FaceSums {
  const SurfaceTally& units;
  std::span<const SurfaceTally::Sums> face;
  double fnum_per_time = 0;  ///< real molecules per particle and second
  std::int64_t n_steps = 0;
};

/// Loads of every patch from the sums of some steps, without the reference's multiplier. Sums are exact, so the result
/// has the same bits on any number of ranks. Collective: one reduction.
std::vector<Load> patch_loads(const par::Comm& comm, const GasDomain& domain, const FaceSums& sums, Vec3 point,
                              std::size_t n_patches);

/// A stress and a heat flux on a face of the boundary.
using SurfaceLaw = std::function<std::pair<Vec3, double>(const BoundaryFace& face)>;
/// Loads of every patch under a law on these faces. Collective: one reduction.
std::vector<Load> integrate_law(const par::Comm& comm, const std::vector<BoundaryFace>& faces, const SurfaceLaw& law,
                                Vec3 point, std::size_t n_patches);

/// Dimensionless loads: drag, lift and pitching moment on rho V^2/2 x area (x length), heat on rho V^3/2 x area.
struct Coefficients {
  double drag = 0, lift = 0, moment = 0, heat = 0;
};

/// Makes loads dimensionless; for a free stream at rest with its most probable speed.
class Scale {
 public:
  Scale(const Gas& gas, const Stream& stream, const Reference& reference);

  Coefficients coefficients(const Load& load) const;
  double dynamic_pressure() const { return pressure_; }
  double speed() const { return speed_; }
  /// Force of a coefficient of 1, N: of the entire body, as the coefficients are.
  double force() const { return pressure_ * reference_.area; }

 private:
  Reference reference_;
  Vec3 drag_, lift_;
  double pressure_ = 0, speed_ = 0;
};

/// Indices of the walls for which a name stands (`mesh::find_patches`). Local.
std::vector<int> walls_named(const std::string& name, const std::vector<mesh::Patch>& patches,
                             const std::vector<BoundaryCondition>& conditions);
/// Whether each patch belongs to the reference body. Local.
std::vector<bool> reference_patches(const Reference& reference, const std::vector<mesh::Patch>& patches,
                                    const std::vector<BoundaryCondition>& conditions);
Load sum_of(const std::vector<Load>& patch, const std::vector<bool>& wanted);

/// Newtonian flow about a convex body: molecules of the stream leave their normal momentum on the faces that they
/// reach.
SurfaceLaw newtonian_law(const Gas& gas, const Stream& stream);

}  // namespace pamr::dsmc
