// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

#include "solvers/dsmc/sampling/estimate.hpp"

namespace pamr::dsmc {

/// A run with a quarter of the particles has particles that stand for so many times as many molecules.
inline constexpr double fewer_particles = 4;

/// The error of a value whose viscosity and conductivity are off by x^2 of themselves, over what it differs where they
/// are off by (ratio x)^2. Friction and heat through a boundary layer are as the root of both, off by
/// sqrt(1 + x^2) - 1. So it is 1 / |ratio^2 - 1| for small x, 1 / |ratio - 1| for large ones.
double error_per_difference(double x, double ratio);
/// The same of N particles, beside N / 4: viscosity and conductivity are off by the square of the distance of partners,
/// over which a collision carries momentum and heat (F. J. Alexander, A. L. Garcia, B. J. Alder, "Cell size dependence
/// of transport coefficients in stochastic particle algorithms", Phys. Fluids 10, 1540 (1998)); partners that collide
/// at the walls are `separation` mean free paths apart, and the distance of nearest partners is as N^(-1/3). From 0.66
/// for near partners to 1.70 for far ones.
double error_of_particles_per_difference(double separation);
/// The same of cells that are `size` mean free paths wide, beside cells half as wide: viscosity is off by
/// 16 / (45 pi) size^2 (the same source, for partners anywhere in the cell). From 4/3 for fine cells to 2 for coarse.
double error_of_cells_per_difference(double size);

/// A coefficient with a quarter of the particles.
struct FewerCoefficient {
  Estimate value;
  double student = 1;     ///< factor from the standard error to the bound of 95 %
  double separation = 0;  ///< of partners at the walls, with all particles, over the mean free path
};

/// A coefficient where cells at the walls are split.
struct SplitCoefficient {
  Estimate value;
  double student = 1;   ///< factor from the standard error to the bound of 95 %
  double size = 0;      ///< of cells at the walls, before they were split, over the mean free path
  double distance = 1;  ///< of partners, over that in the cells that were split
};

/// A coefficient of the body with all particles, with a quarter of them and, if asked for, with finer cells.
struct CheckedCoefficient {
  std::string name;
  Estimate all;
  double student = 1;                       ///< factor from the standard error to the bound of 95 %
  double facets = 0;                        ///< `error_of_facets`
  std::optional<FewerCoefficient> fewer{};  ///< none where molecules do not collide, so that their number adds nothing
  std::optional<SplitCoefficient> split{};

  Estimate difference() const;  ///< of `fewer`, with its standard error. Pre: `fewer`.
  /// Estimate of the error that comes from the number of particles, at least what the noise of the difference hides:
  /// the difference, or twice its standard error if that is more, times `error_of_particles_per_difference`; 0 without
  /// `fewer`.
  double error() const;
  /// Of `split`, without what comes from partners that are farther apart there, because fewer particles share a cell:
  /// by the law of particles a part of `difference`. So particles do not count twice. Pre: `fewer` and `split`.
  Estimate difference_of_cells() const;
  /// Estimate of the error that comes from the size of the cells at the walls, as `error`; 0 without `split`.
  double error_of_cells() const;
  /// Of chance, of the number of particles, of cells and of flat faces together.
  double bound() const { return student * all.error + error() + error_of_cells() + facets; }
};

nlohmann::json to_json(const CheckedCoefficient& checked);
/// One line. Local.
std::string describe(const CheckedCoefficient& checked);

}  // namespace pamr::dsmc
