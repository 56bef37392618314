// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "solvers/poisson_boltzmann/conditions.hpp"
#include "solvers/poisson_boltzmann/source_term.hpp"

namespace pamr::poisson_boltzmann {

/// The mirrors that cut a body or a plane: how much of it is in the mesh.
struct Mirrors {
  double factor = 1;  ///< full body over meshed part
  bool cut[3]{};      ///< the mirror normal to this axis cuts it: that component of a force vanishes
  geometry::Vec3 complete(geometry::Vec3 force) const {
    return {cut[0] ? 0 : factor * force.x, cut[1] ? 0 : factor * force.y, cut[2] ? 0 : factor * force.z};
  }
};

/// Mirrors (patches with condition symmetry that are flat and normal to an axis) that share nodes with each patch of
/// the mesh. Other mirrors do not count, nor do two of the same direction: between them a body has no end. Collective:
/// one reduction.
std::vector<Mirrors> find_mirrors(const par::Comm& comm, const Domain& domain, const Case& problem);

/// Everything that a solution is made of, for what is computed from it. Arrays by local nodes or cells.
struct State {
  const Domain& domain;
  const Case& problem;
  const Conditions& conditions;
  std::span<const double> u;
  std::span<const double> reaction;
  std::span<const geometry::Vec3> cell_gradient;  ///< of u
  std::span<const geometry::Vec3> recovered;      ///< of u
  std::span<const Mirrors> mirrors;
};

/// Charge of each patch and forces on it, dimensionless, on full bodies; less what the plate profile alone exerts where
/// it is split off. A force that does not exist for a patch is left out.
struct PatchResult {
  std::string name;
  double symmetry_factor = 1;
  double area = 0;                                 ///< meshed, squared Debye lengths
  double charge = 0;                               ///< by nodal reactions; full body
  double charge_density = 0;                       ///< charge of the meshed part over its area
  geometry::Vec3 surface;                          ///< stress of the raw gradient over the surface, after Dyshlovenko
  geometry::Vec3 surface_recovered;                ///< the same with the recovered gradient
  std::optional<geometry::Vec3> surface_reaction;  ///< the same with the nodal charges, where u is given
  std::optional<geometry::Vec3> volume;            ///< with the cut-off function round a sphere
  std::optional<geometry::Vec3> midplane;          ///< through the mirror between two spheres
  double inner = 0, outer = 0;                     ///< of the cut-off function
};

/// Charges and surface forms of all patches. Collective: exact sums.
std::vector<PatchResult> surface_results(const par::Comm& comm, const State& state);

/// Cut-off function round a sphere at the nodes: 1 nearer than `inner` to its surface, 0 beyond `outer`, smooth
/// between.
struct CutOff {
  std::vector<double> chi;
  double inner = 0, outer = 0;
};
/// `outer` is at most 0.95 of the distance to the nearest other boundary (mirrors that cut the sphere do not count),
/// and 4 Debye lengths; `inner` half of it. Nothing where a boundary that is no such mirror touches the sphere.
/// Collective: a reduction. Throws `Error` when the case asks for more.
std::optional<CutOff> make_cut_off(const par::Comm& comm, const State& state, const Sphere& sphere, int patch);

/// The same for the plate, by the height over it: it ends below the spheres. Holds where the side walls are mirrors or
/// so far away that the potential there is that of the profile. Pre: the case has a plate. Collective: a reduction.
CutOff make_plate_cut_off(const par::Comm& comm, const State& state);

/// f_i = - integral of T_ij d_j chi, on the meshed part. T = grad psi grad psi - (|grad psi|^2/2 + cosh psi - 1) 1 less
/// that of psi0. Collective: exact sums.
geometry::Vec3 volume_force(const par::Comm& comm, const State& state, std::span<const double> chi);
/// d f_axis / du at the nodes. Collective: one exchange.
std::vector<double> volume_force_derivative(const par::Comm& comm, const State& state, std::span<const double> chi,
                                            int axis);

/// Integral over a mirror, of the meshed part: |grad_t u|^2/2 + cosh(psi0 + u) - cosh psi0 - u sinh psi0. Positive:
/// what lies on this side of the mirror is pushed away from it. Collective: an exact sum.
double midplane_force(const par::Comm& comm, const State& state, int patch);
/// Its derivative. Collective: one exchange.
std::vector<double> midplane_derivative(const par::Comm& comm, const State& state, int patch);

/// Integral of |grad psi|^2/2 + cosh psi - 1 over the mesh; the second, less that of psi0 alone.
struct Energy {
  double total = 0, excess = 0;
};
Energy energy_of(const par::Comm& comm, const State& state);

}  // namespace pamr::poisson_boltzmann
