// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "solvers/dsmc/run/advance.hpp"
#include "solvers/dsmc/run/computation.hpp"

namespace pamr::dsmc {

/// A run with a quarter of the particles has particles that stand for so many times as many molecules.
inline constexpr double fewer_particles = 4;
/// The error of N particles over what N / 4 differ from them, where partners that collide at the walls are `separation`
/// mean free paths apart. Viscosity and conductivity are off by the square of the distance of partners, over which a
/// collision carries momentum and heat (F. J. Alexander, A. L. Garcia, B. J. Alder, "Cell size dependence of transport
/// coefficients in stochastic particle algorithms", Phys. Fluids 10, 1540 (1998)); friction and heat through a boundary
/// layer are as their square root, off by sqrt(1 + separation^2) - 1; and the distance of nearest partners is as
/// N^(-1/3). So it is 1 / (4^(2/3) - 1) = 0.66 for near partners, 1 / (4^(1/3) - 1) = 1.70 for far ones.
double error_per_difference(double separation);

/// A coefficient of the body with all particles and with a quarter of them.
struct CheckedCoefficient {
  std::string name;
  Estimate all, fewer;
  double student_all = 1, student_fewer = 1;  ///< factors from standard errors to bounds of 95 %
  double separation = 0;                      ///< of partners at the walls, with all particles, over the mean free path
  double facets = 0;                          ///< `error_of_facets`

  double difference() const { return fewer.value - all.value; }
  double difference_error() const;  ///< standard error
  /// Estimate of the error that comes from the number of particles, at least what the noise of the difference hides:
  /// the difference, or twice its standard error if that is more, times `error_per_difference(separation)`.
  double error() const;
  /// Of chance, of the number of particles and of flat faces together.
  double bound() const { return student_all * all.error + error() + facets; }
};

struct ParticleCheck {
  std::vector<CheckedCoefficient> coefficients;  ///< C_D, C_L, C_m, C_H; without lift C_D, C_H
  std::int64_t n_particles = 0;                  ///< of the second run, at its end
  std::uint64_t n_steps = 0;                     ///< of it
};

/// Goes on from the gas of a computation that has ended with a quarter of the particles, on the same mesh, until it has
/// as many averaged steps, after the transient of the case and a passage. The computation stays as it is.
/// `separation` is `CellResolution::wall_separation` of it. Collective.
/// Throws `Error` for a computation without averages or with windows.
ParticleCheck check_particles(const Computation& computation, double separation, const Observer& observer);

/// Throws `Error` for a case that cannot be checked. Local.
void require_checkable(const Case& the_case);

nlohmann::json to_json(const ParticleCheck& check);
/// A line for each coefficient. Local.
std::vector<std::string> describe(const ParticleCheck& check);

}  // namespace pamr::dsmc
