// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace pamr::dsmc {

inline constexpr double boltzmann = 1.380649e-23;  ///< J/K

/// A kind of molecule and its reference values for variable spheres (hard, VHS where `alpha` is 1, VSS elsewhere).
struct Species {
  std::string name;
  double mass = 0;      ///< kg
  double diameter = 0;  ///< m, at `t_ref`
  double omega = 0.5;   ///< viscosity ~ T^omega
  double t_ref = 273;   ///< K
  double alpha = 1;     ///< exponent of the scattering law
  int rotational_degrees = 0;
  /// Molecules that a particle of this species stands for, over those of a particle of weight 1 in the same cell: below
  /// 1 for a trace species, which then has more particles.
  double weight = 1;
};

/// How often a molecule's rotation takes part in a collision.
struct Rotation {
  enum class Model : std::uint8_t {
    probability,  ///< of one molecule in one collision
    z_continuum,  ///< from the relaxation number of the Jeans equation
    variable      ///< Parker's relaxation number of the Jeans equation, from the cell's temperature
  };
  Model model = Model::probability;
  double value = 0.2;  ///< the probability, or the number
  double z_infinity = 18.1;
  double t_star = 91.5;  ///< K
};

/// What the collision of two kinds of molecules needs, precomputed.
struct PairData {
  double coefficient = 0;  ///< cross section times speed = coefficient * (c^2)^exponent
  double exponent = 0;     ///< 1 - omega
  double reduced_mass = 0;
  double mass_part_a = 0;  ///< m_a / (m_a + m_b)
  double mass_part_b = 0;
  double inverse_alpha = 1;
  double translational_exponent = 0;  ///< 5/2 - omega: half the degrees of freedom of relative motion
  double weight = 1;                  ///< the greater of the two species' weights
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

/// Fills the table of pairs: diameters, exponents and reference temperatures of unlike molecules are the means.
/// Throws `Error` for values without sense.
void prepare(Gas& gas);

/// Particles of each molecule of weight 1 in a gas of these parts: the sum of the parts over the weights.
double particles_per_molecule(const Gas& gas, const std::vector<double>& fraction);

/// Cross section times relative speed, m3/s, from the squared relative speed.
inline double section_times_speed(const PairData& pair, double speed_squared) {
  return pair.coefficient * std::pow(speed_squared, pair.exponent);
}

/// Chance that a molecule of this kind exchanges rotational energy in a collision within a gas of temperature `t`
/// (needed by the variable model), before any clamp. `omega` of the pair. A continuum number Z gives
/// (zeta_r + 5 - 2 omega) / (Z (5 - 2 omega)) when at most one partner relaxes in a collision.
double relaxation_probability(const Rotation& rotation, int rotational_degrees, double omega, double t);

}  // namespace pamr::dsmc
