// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "solvers/poisson_boltzmann/state.hpp"

namespace pamr::poisson_boltzmann {

/// Cut-off function around a body at the nodes: 1 nearer than `inner` to its surface, 0 beyond `outer`, smooth between.
struct CutOff {
  std::vector<double> chi;  ///< n_nodes
  double inner = 0, outer = 0;
};

/// The cut-off function around a sphere with that patch.
/// - `outer` is at most 0.95 of the distance to the nearest other boundary and 4 Debye lengths, `inner` half of it.
///   Mirrors that cut the sphere are no other boundary.
/// - Nothing if another boundary touches the sphere.
/// - Collective: a reduction. Throws `Error` when the case asks for more room than there is.
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

}  // namespace pamr::poisson_boltzmann
