// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/geometry/vec3.hpp"
#include "solvers/poisson_boltzmann/problem/plate_profile.hpp"
#include "solvers/poisson_boltzmann/problem/site_charge.hpp"
#include "solvers/poisson_boltzmann/problem/source_term.hpp"
#include "solvers/poisson_boltzmann/problem/units.hpp"

namespace pamr::poisson_boltzmann {

/// What holds on one patch of the boundary. n points out of the liquid.
enum class Condition {
  potential,      ///< psi = value
  charge,         ///< dpsi/dn = value: the charge density of the body behind it, sigma = -dpsi/dn out of the body; of a
                  ///< sheet what dpsi/dn out of the liquid adds up to on both sides
  regulated,      ///< the same with a charge density that follows from psi: `Boundary::site`
  symmetry,       ///< dpsi/dn = 0: a mirror
  plate_profile,  ///< psi = psi0(z) of the plate, 0 without one
  far_field,      ///< d(psi - psi0)/dn = -alpha (psi - psi0), alpha of the decay of spheres far away
  manufactured    ///< psi = the manufactured solution
};
const char* name_of(Condition condition);
/// Whether psi itself is given.
bool fixes_potential(Condition condition);

struct Boundary {
  std::string patch;       ///< a name, or a pattern of names until `resolve_names` (base/name_pattern.hpp)
  std::string pattern;     ///< the pattern that stood for the patch; empty where its name or that of a group did
  bool is_inside = false;  ///< `patch` is a sheet: all of its faces lie inside (`with_sheets`)
  Condition condition = Condition::symmetry;
  double value = 0;  ///< dimensionless
  SiteCharge site;   ///< of `regulated`

  /// Whether a charge density is given, or how it follows from the potential, and it is not always 0.
  bool holds_charge() const {
    return condition == Condition::regulated || (condition == Condition::charge && value != 0);
  }
  /// That density at a potential, and its derivative; 0 where there is none. Of a sheet that of one of its sides, half
  /// of what both hold together.
  double charge_at(double psi) const {
    if (condition == Condition::regulated) return site.value(psi);
    return condition != Condition::charge ? 0 : is_inside ? 0.5 * value : value;
  }
  double charge_slope_at(double psi) const { return condition == Condition::regulated ? site.slope(psi) : 0; }
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

/// Patches of the mesh that are one body: forces, torques and charges are given for all of them together.
struct Body {
  std::string name;
  std::vector<std::string> patches;      ///< names, or patterns of names until `resolve_names`
  std::optional<geometry::Vec3> center;  ///< of the torque, Debye lengths; nothing: the centroid of the surface
};

/// A quantity whose error the dual solution estimates.
struct Goal {
  enum class Kind { midplane, force, torque, charge, energy };
  Kind kind = Kind::force;
  int axis = 0;      ///< of a force or a torque
  std::string body;  ///< patch or body whose quantity it is; empty for `midplane` and `energy`
  std::string name;  ///< "force-x"
};

enum class Quadrature { nodal, gauss };
enum class Recovery { volume_weighted, plain };

struct SolverOptions {
  Exact<int> order = 1;                       ///< of the elements: 2 isoparametric, with mid-edge nodes on the surfaces
  Quadrature quadrature = Quadrature::nodal;  ///< of first order
  double tolerance =
      1e-10;  ///< of the residual, over that of the potential that is 0 off the boundary (`System::solve`)
  Exact<int> max_newton = 60;
  std::string preconditioner = "auto";  ///< by size (`choose_preconditioner`), "jacobi" or "boomeramg"
  std::string petsc;                    ///< options for PETSc that `check_petsc_options` lets pass
};

struct ForceOptions {
  std::string midplane;         ///< patch of the mirror between two spheres; empty: no mid-plane form
  std::optional<double> inner;  ///< the cut-off function of spheres is 1 nearer to the surface, Debye lengths
  std::optional<double> outer;  ///< and 0 farther away
};

struct EstimatorOptions {
  Recovery recovery = Recovery::volume_weighted;
  std::vector<Goal> goals;  ///< the first decides the report's `goal`
};

/// One problem as a case file states it, dimensionless.
struct Case {
  Electrolyte electrolyte;
  std::string length_unit = "debye";
  bool linear = false;        ///< psi for sinh(psi)
  bool manufactured = false;  ///< with the source that makes psi* = 2 sin x cos y exp(-z) the solution
  bool split = false;         ///< solve for u = psi - psi0(z)
  std::vector<Boundary> boundary;
  std::vector<std::string> open_inside;  ///< patches inside, or in part, that hold nothing there (`with_sheets`)
  std::vector<Sphere> spheres;
  std::optional<Plate> plate;
  std::vector<Body> bodies;  ///< as `[[body]]` states them
  SolverOptions solver;
  ForceOptions force;
  EstimatorOptions estimator;

  /// What holds on the patch: stated for its own name, or for a pattern that stands for it. Null if nothing does.
  const Boundary* find_boundary(std::string_view patch) const;
  /// True where that patch holds a charge, sites or a potential: forces on it and its charge have a meaning.
  bool is_electrode(std::string_view patch) const;
  /// Whether the charge of any patch follows from its potential.
  bool has_regulated() const;
  /// psi0(z); 0 without a plate.
  PlateProfile profile() const;
  /// The right-hand side of the equation.
  SourceTerm term() const { return SourceTerm(linear, electrolyte.ions); }
};

/// Largest potential that is accepted where the equation is not linear, kT/Ze: there the layer at a wall is 3e-11 Debye
/// lengths thick, which neither a mesh nor the coordinates of one can hold, and its profile is the same as that of any
/// larger potential but for that layer. Ions of charge z are accepted up to a z-th part of it.
inline constexpr double largest_potential = 50;

/// Debye lengths in one `unit` ("debye", "m", "um", "nm"), or nothing when the unit is unknown. Throws `Error` when the
/// unit is a length and the electrolyte has no Debye length.
std::optional<double> debye_lengths_in(std::string_view unit, const Electrolyte& electrolyte, const std::string& where);

/// Reads a case file (docs/tools/pamr-pb.md); tables of other tools are ignored. `where` is the file's name. Local.
/// Throws `Error`
/// - with file, line and column for TOML errors, unknown keys, wrong types and values out of range;
/// - for ions whose charges do not add up to 0, a plate in a salt that is not Z:Z, spheres that overlap or touch the
///   plate, and lengths that contradict each other;
/// - for potentials beyond `largest_potential`, or charges or sites that make such;
/// - when no patch has a given potential or charge.
Case read_case(std::string_view text, const std::string& where);

/// The case in lines for the user: dimensional and dimensionless quantities side by side, and what holds where.
std::vector<std::string> describe(const Case& problem);

}  // namespace pamr::poisson_boltzmann
