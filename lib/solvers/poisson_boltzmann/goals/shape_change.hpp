// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>

#include "pamr/geometry/surface.hpp"
#include "solvers/poisson_boltzmann/goals/functionals.hpp"

/// The error of a goal from replacing curved surfaces by faces of the mesh, for elements of both orders: the derivative
/// of the functional with respect to the shape (J. Hadamard, 1908). With the normal n into the liquid and the wall
/// moved by d along it, the residual of the equation changes by
///
///     potential given:  -d psi_n w_n                                     (the potential moves along with the wall)
///     charge given:     -d [grad_t psi . grad_t w + sinh(psi) w] - sigma w s
///     sites:            the same + d sigma sigma' w, sigma' = dsigma/dpsi
///
/// where s is the area of the surface over that of the face, less 1. It is 2 H d with the mean curvature H for a wall
/// that moves as a whole. Between a face and a surface the tilt of the one against the other is of the same order: it
/// takes away half of what the curvature adds for chords of a circle. So s is measured, which needs no curvature.
/// A goal that is the charge of sites changes by sigma (s - d sigma') itself.
namespace pamr::poisson_boltzmann {

/// True where this file knows what a curved face misses: a surface that is not flat, and a potential or charge that is
/// given, sites, or a mirror (a charge of 0). Local.
bool is_curved_wall(const Boundary& boundary, const geometry::Surface* surface);

/// A point of a face.
struct WallPlace {
  geometry::Vec3 point;   ///< Debye lengths
  geometry::Vec3 normal;  ///< unit, out of the liquid
  double area = 0;        ///< that the point stands for
};

/// How a surface lies to a face at a point of it. `stretch` is 0 where a potential is given.
struct WallShift {
  double distance = 0;  ///< to the surface, positive where it lies on the side of the liquid; Debye lengths
  double stretch = 0;   ///< area of the surface for a unit of area of the face, less 1
};
/// `size`: length of the face's edges. Cost: one projection, or five. Local.
WallShift wall_shift(const Domain& domain, const Boundary& boundary, const geometry::Surface& surface,
                     const WallPlace& place, double size);

/// Solution and dual solution at a point of a wall.
struct WallTraces {
  geometry::Vec3 normal;    ///< unit, out of the liquid
  geometry::Vec3 gradient;  ///< of psi
  double u = 0, psi0 = 0;
  double base = 0;  ///< slope of the profile that is split off
  geometry::Vec3 dual_gradient;
  double w = 0;
  double counted = 0;  ///< 1 where the goal is the charge of the sites there
};
/// Change of the functional for a unit of area of the face. Local.
double shape_change(const Problem& problem, const Goal& goal, const Boundary& boundary, const WallTraces& at,
                    WallShift shift);

/// Bounds the second-order part of the error of the shape relative to the first-order part: at most distance times wave
/// number of the gap between a face and its surface. Both are root mean squares over points of the face; the wave
/// number is the slope of the gap over its depth.
class GapWave {
 public:
  void add(const Domain& domain, const geometry::Surface& surface, const WallPlace& place, double distance);
  double number() const;

 private:
  double squared_tilts_ = 0, squared_distances_ = 0;
};

/// Size of what charges of walls miss at the edges of their patches, where the surface goes on beyond the straight or
/// curved edges of the mesh or ends before them: the sum of charge, dual solution w (n_nodes) and width, without signs.
/// On patches of sites whose charge is the goal (`counted`, bit p for patch p) w is less by 1. 0 where the walls meet
/// at right angles. Collective: a few reductions.
double charge_at_edges(const par::Comm& comm, const State& state, std::uint64_t counted, std::span<const double> w);

}  // namespace pamr::poisson_boltzmann
