// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "solvers/dsmc/gas/vibration.hpp"

namespace pamr::dsmc {

inline constexpr double boltzmann = 1.380649e-23;  ///< J/K

/// A kind of molecule and its reference values as variable hard spheres (`alpha` = 1) or variable soft spheres.
struct Species {
  std::string name;
  double mass = 0;      ///< kg
  double diameter = 0;  ///< m, at `t_ref`
  double omega = 0.5;   ///< viscosity ~ T^omega
  double t_ref = 273;   ///< K
  double alpha = 1;     ///< exponent of the scattering law
  int rotational_degrees = 0;
  /// F_num of this species divided by F_num of the cell. Below 1 for a trace species, which then has more particles.
  double weight = 1;
  Vibration vibration = {};  ///< empty where the case computes none
};

/// How often a collision exchanges energy with a molecule's rotation.
struct Rotation {
  enum class Model : std::uint8_t {
    probability,  ///< per molecule and collision
    z_continuum,  ///< from the relaxation number of the Jeans equation
    variable      ///< Parker's relaxation number of the Jeans equation, from the cell's temperature
  };
  Model model = Model::probability;
  double value = 0.2;  ///< the probability, or the number
  double z_infinity = 18.1;
  double t_star = 91.5;  ///< K
};

/// Precomputed values for collisions of two kinds of molecules.
struct PairData {
  double coefficient = 0;  ///< cross section times speed = coefficient * (c^2)^exponent
  double exponent = 0;     ///< 1 - omega
  double reduced_mass = 0;
  double mass_part_a = 0;  ///< m_a / (m_a + m_b)
  double mass_part_b = 0;
  double inverse_alpha = 1;
  double translational_exponent = 0;  ///< 5/2 - omega: half the degrees of freedom of relative motion
  double weight = 1;                  ///< the larger of the two species' weights
};

/// A gas of one or more species; `fraction[i]` of its molecules are of species i (sum 1).
struct Gas {
  std::vector<Species> species;
  std::vector<double> fraction;
  Rotation rotation;

  const PairData& pair(std::size_t a, std::size_t b) const { return pairs[a * species.size() + b]; }
  std::vector<PairData> pairs;                ///< filled by `prepare`
  bool is_weighted = false;                   ///< filled by `prepare`: the species have different weights
  bool is_vibrating = false;                  ///< filled by `prepare`: some species has modes of vibration
  std::vector<RelaxingShare> relaxing_share;  ///< of each pair, filled by `prepare`; empty: nothing vibrates

  /// Of each species, as `temperature_of_vibration` takes them.
  std::vector<const Vibration*> vibrations() const;
  double mean_mass() const;
  double mean_degrees() const;  ///< 3 + rotational
  /// gamma = (degrees + 2) / degrees in equilibrium at `t`, K, where vibration counts by its heat capacity.
  double heat_ratio(double t) const;
};

/// Whether at a temperature (K) vibration and chemistry matter, the latter of which is never modeled: the gas has
/// molecules of two or more atoms, and it is above 2,500 K. Local.
bool is_hot(const Gas& gas, double temperature);
/// Text of the warning about it, by what the gas has.
const char* missing_when_hot(const Gas& gas);

/// Fills the table of pairs; diameters, exponents and reference temperatures of a pair are the means of its molecules.
/// Throws `Error` for values that make no sense.
void prepare(Gas& gas);

/// Particles per molecule, in units of 1 / F_num, in a gas with these fractions: the sum of fraction over weight.
double particles_per_molecule(const Gas& gas, const std::vector<double>& fraction);

/// Cross section times relative speed, m3/s, from the squared relative speed.
inline double section_times_speed(const PairData& pair, double speed_squared) {
  return pair.coefficient * std::pow(speed_squared, pair.exponent);
}

/// Probability that a molecule exchanges rotational energy in a collision, before it is limited to 1/2. `omega`: of the
/// pair; `t`: temperature of the gas, K, used by the variable model. A continuum relaxation number Z gives
/// (zeta_r + 5 - 2 omega) / (Z (5 - 2 omega)), since at most one molecule relaxes per collision.
double relaxation_probability(const Rotation& rotation, int rotational_degrees, double omega, double t);

/// Collisions of a molecule in which its vibration relaxes by a factor of e, the relaxation time times the collision
/// frequency at `t` (K): c1 / T^omega exp(c2 / T^(1/3)), and in addition where a limit is given sqrt(2) sigma_T /
/// sigma_v with sigma_v = cross_section (50,000 / T)^2, without which hot molecules would relax more often than they
/// collide.
/// Source: R. C. Millikan, D. R. White, "Systematics of vibrational relaxation", J. Chem. Phys. 39 (1963), in the form
/// of G. A. Bird 1994, chapter 6; the limit: C. Park, "Review of chemical-kinetic problems of future NASA missions, I:
/// Earth entries", J. Thermophys. Heat Transfer 7 (1993).
double vibration_number(const Species& species, double t);

/// Probability that in a collision a mode of a molecule of species `a` exchanges energy with the motion relative to one
/// of species `b`, in gas of temperature `t` (K), so that the mean energy relaxes in `vibration_number` collisions.
double vibration_chance(const Gas& gas, std::size_t a, std::size_t b, std::size_t mode, double t);

}  // namespace pamr::dsmc
