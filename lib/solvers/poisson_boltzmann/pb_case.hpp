// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/geometry/vec3.hpp"
#include "solvers/poisson_boltzmann/plate_profile.hpp"
#include "solvers/poisson_boltzmann/units.hpp"

namespace pamr::poisson_boltzmann {

/// What holds on one patch of the boundary. n points out of the liquid.
enum class Condition {
  potential,      ///< psi = value
  charge,         ///< dpsi/dn = value: the charge density of the body behind it, sigma = -dpsi/dn out of the body
  symmetry,       ///< dpsi/dn = 0: a mirror
  plate_profile,  ///< psi = psi0(z) of the plate, 0 without one
  far_field,      ///< d(psi - psi0)/dn = -alpha (psi - psi0), alpha of the decay of spheres far away
  manufactured    ///< psi = the manufactured solution
};
const char* name_of(Condition condition);

struct Boundary {
  std::string patch;
  Condition condition = Condition::symmetry;
  double value = 0;  ///< dimensionless
};

/// A charged sphere; lengths in Debye lengths. `patch` is empty for one beyond a mirror, which is not in the mesh.
struct Sphere {
  std::string patch;
  geometry::Vec3 center;
  double radius = 0;
};

/// The infinite plate z = position; its potential is that of its patch.
struct Plate {
  std::string patch;
  double position = 0;   ///< Debye lengths
  double potential = 0;  ///< kT/Ze
};

enum class Quadrature { nodal, gauss };
enum class Recovery { volume_weighted, plain };

struct SolverOptions {
  Quadrature quadrature = Quadrature::nodal;
  double tolerance = 1e-10;  ///< of the residual, over that of the potential that is 0 off the boundary
  int max_newton = 60;
  std::string preconditioner = "jacobi";  ///< or "boomeramg"
  std::string petsc;                      ///< options for PETSc, as on its command line
};

struct ForceOptions {
  std::string midplane;         ///< patch of the mirror between two spheres; empty: no mid-plane form
  std::optional<double> inner;  ///< the cut-off function is 1 nearer to a sphere's surface, Debye lengths
  std::optional<double> outer;  ///< and 0 farther away
};

struct EstimatorOptions {
  Recovery recovery = Recovery::volume_weighted;
  std::string goal = "none";  ///< "midplane", "volume-x", "volume-y", "volume-z", "charge" (of patch `goal_patch`)
  std::string goal_patch;
};

/// One problem as a case file states it, dimensionless.
struct Case {
  Electrolyte electrolyte;
  std::string length_unit = "debye";
  bool linear = false;        ///< psi for sinh(psi)
  bool manufactured = false;  ///< with the source that makes psi* = 2 sin x cos y exp(-z) the solution
  bool split = false;         ///< solve for u = psi - psi0(z)
  std::vector<Boundary> boundary;
  std::vector<Sphere> spheres;
  std::optional<Plate> plate;
  SolverOptions solver;
  ForceOptions force;
  EstimatorOptions estimator;

  const Boundary* find_boundary(std::string_view patch) const;
  /// psi0(z); 0 without a plate.
  PlateProfile profile() const;
};

/// Largest potential that is accepted, kT/Ze: beyond it the squares of sinh overflow.
inline constexpr double largest_potential = 300;

/// Debye lengths in one `unit` ("debye", "m", "um", "nm"), or nothing when the unit is unknown. Throws `Error` when the
/// unit is a length and the electrolyte has no Debye length.
std::optional<double> debye_lengths_in(std::string_view unit, const Electrolyte& electrolyte, const std::string& where);

/// Reads a case file (docs/tools/pamr-pb.md); tables of other tools are ignored. `where` is the file's name. Local.
/// Throws `Error`
/// - with file, line and column for TOML errors, unknown keys, wrong types and values out of range;
/// - for salts that are not Z:Z, spheres that overlap or touch the plate, and lengths that contradict each other;
/// - when no patch has a given potential or charge.
Case read_case(std::string_view text, const std::string& where);

/// The case in lines for the user: dimensional and dimensionless quantities side by side, and what holds where.
std::vector<std::string> describe(const Case& problem);

}  // namespace pamr::poisson_boltzmann
