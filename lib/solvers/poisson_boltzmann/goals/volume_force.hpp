// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "solvers/poisson_boltzmann/fem/state.hpp"

namespace pamr::poisson_boltzmann {

/// One component of a force, or of a torque about a point, as the direction that the stress is weighted with.
struct Component {
  int axis = 0;
  bool is_torque = false;
  geometry::Vec3 center;  ///< of a torque

  geometry::Vec3 at(geometry::Vec3 point) const;
};

/// Force and torque on what a cut-off function belongs to, on the meshed part.
struct VolumeForm {
  geometry::Vec3 force, torque;
  geometry::Vec3 through_walls;  ///< part of `force` that comes from the open walls
};

/// f = - integral of T grad chi + integral of chi T n over the open walls, n out of the liquid, and the torque about
/// `center`, in which (x - center) x (T grad chi) takes the place of T grad chi: it has the same value for every chi,
/// because T is symmetric and free of divergence. T = grad psi grad psi - (|grad psi|^2/2 + cosh psi - 1) 1 less that
/// of psi0. `chi` is that of the nodes, bit p of `open_walls` stands for patch p. Collective: exact sums.
VolumeForm volume_form(const par::Comm& comm, const State& state, std::span<const double> chi,
                       std::uint64_t open_walls = 0, geometry::Vec3 center = {});
/// Derivative of one component by the functions of `GoalSpace`, which says whether it contains what open walls give.
/// Collective: one exchange.
std::vector<double> volume_form_derivative(const par::Comm& comm, const State& state, std::span<const double> chi,
                                           std::uint64_t open_walls, const Component& component);

/// n_cells: what the known error of the solution (`GoalSpace`) adds to one component in second order. It is as large as
/// what the dual solution gives, because the stress is quadratic in the gradient. Local.
std::vector<double> volume_form_remainder(const State& state, std::span<const double> chi, std::uint64_t open_walls,
                                          const Component& component);

}  // namespace pamr::poisson_boltzmann
