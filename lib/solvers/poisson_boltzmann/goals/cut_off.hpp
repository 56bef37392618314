// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "solvers/poisson_boltzmann/fem/solve.hpp"
#include "solvers/poisson_boltzmann/goals/electrodes.hpp"

namespace pamr::poisson_boltzmann {

/// Cut-off function of a body at the nodes: 1 on the body, 0 on every boundary apart from it, smooth between.
struct CutOff {
  std::vector<double> chi;       ///< n_nodes; empty where there is none
  std::uint64_t open_walls = 0;  ///< patches that meet the body and are no mirrors: chi is not 0 there
  double inner = 0, outer = 0;   ///< of a sphere, where the case states them; 0 of a function from the mesh
  std::string reason;            ///< why there is none
};

/// Why an electrode has no cut-off function; empty where it has one. Local.
std::string no_cut_off(const Problem& problem, const Electrode& electrode);

/// The cut-off function of an electrode.
/// - It comes from the discrete harmonic function that is 1 on the body and 0 on every patch apart from it, with
///   mirrors and walls that meet the body left free: chi is 1 where that is over 0.5, 0 where it is under 0.1, and a
///   cubic between. A mirror that does not cut the body counts as apart from it, so that the body's image is none of
///   it.
/// - Around a sphere with `inner` or `outer` in the case it is a cubic of the distance to the surface.
/// - There is none where another electrode meets the body, or where no boundary is apart from it.
/// - Collective: one linear system of the stiffness matrix, solved to 1e-3. Throws `Error` when the case asks for more
///   room around a sphere than there is.
CutOff make_cut_off(const par::Comm& comm, const Problem& problem, System& system, const Electrode& electrode);

}  // namespace pamr::poisson_boltzmann
