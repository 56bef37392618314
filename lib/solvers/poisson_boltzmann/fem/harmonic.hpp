// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "solvers/poisson_boltzmann/fem/stiffness.hpp"

namespace pamr::poisson_boltzmann {

/// The discrete harmonic function that is 1 on the patches of `one`, 0 on those of `zero` (bit p for patch p; `one`
/// decides where they meet) and free elsewhere, by conjugate gradients with the diagonal as preconditioner, whose
/// iterates are the same on any ranks but for rounding. They stop where the residual has fallen by 1e-3:
/// functions and forces made with it depend on that. Collective:
/// an exchange and two small gathers an iteration.
std::vector<double> harmonic_function(const par::Comm& comm, const Domain& domain, const SymmetricRows& rows,
                                      std::uint64_t one, std::uint64_t zero);

}  // namespace pamr::poisson_boltzmann
