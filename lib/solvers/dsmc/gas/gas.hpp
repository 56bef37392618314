// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

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
  std::vector<PairData> pairs;  ///< filled by `prepare`
  bool is_weighted = false;     ///< filled by `prepare`: the species have different weights

  double mean_mass() const;
  double mean_degrees() const;  ///< 3 + rotational
  double heat_ratio() const;    ///< gamma = (degrees + 2) / degrees
};

/// Whether a temperature (K) is one at which the vibration of molecules and chemistry, which are not modeled, matter: the
/// gas has molecules of two or more atoms, and it is above 2,500 K. Local.
bool lacks_vibration(const Gas& gas, double temperature);
/// Text of the warning about it.
inline constexpr const char* without_vibration =
    "above 2,500 K molecules vibrate and react, which is not modeled: the real gas is cooler and has more atoms";

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

}  // namespace pamr::dsmc
