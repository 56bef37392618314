// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

/// Vibration of molecules: each mode is a harmonic oscillator on one of the levels 0, 1, 2, ... of equal distance.
/// Energy counts from level 0.
namespace pamr::dsmc {

inline constexpr std::size_t max_modes = 4;

/// The modes of a kind of molecule, and how fast they relax.
struct Vibration {
  /// K, characteristic temperature of each mode, at most `max_modes`; a degenerate mode is there as often as it is.
  /// Empty: no vibration.
  std::vector<double> mode;
  double c1 = 0, c2 = 0;     ///< collisions to relax: c1 / T^omega exp(c2 / T^(1/3)) (see `vibration_number`)
  double cross_section = 0;  ///< m2 at 50,000 K, the limit at high temperatures; 0: none
};

/// The levels of a molecule's modes in one word: 32 bits over the number of modes for each, the first in the lowest.
namespace levels {

inline std::uint32_t highest(std::size_t n_modes) {
  return static_cast<std::uint32_t>((std::uint64_t{1} << (32 / n_modes)) - 1);
}
inline std::uint32_t of_mode(std::uint32_t word, std::size_t mode, std::size_t n_modes) {
  return (word >> (32 / n_modes * mode)) & highest(n_modes);
}
inline std::uint32_t with(std::uint32_t word, std::size_t mode, std::size_t n_modes, std::uint32_t level) {
  const auto shift = 32 / n_modes * mode;
  return (word & ~(highest(n_modes) << shift)) | (level << shift);
}

}  // namespace levels

/// Energy of a molecule on these levels, over Boltzmann's constant: K.
inline double vibrational_energy(const Vibration& vibration, std::uint32_t word) {
  const auto n = vibration.mode.size();
  double sum = 0;
  for (std::size_t i = 0; i < n; ++i) sum += vibration.mode[i] * levels::of_mode(word, i, n);
  return sum;
}

/// Mean energy of a molecule in equilibrium at `t`, over Boltzmann's constant: K. 0 at 0 K.
double mean_vibrational_energy(const Vibration& vibration, double t);
/// Its derivative, the heat capacity over Boltzmann's constant.
double vibrational_heat(const Vibration& vibration, double t);

/// The temperature at which so many molecules of each kind (any unit) have this energy in equilibrium, K; `energy` over
/// Boltzmann's constant in the same unit. 0 for no energy, and where nothing vibrates.
double temperature_of_vibration(const std::vector<const Vibration*>& kinds, const std::vector<double>& n,
                                double energy);

/// By what share of the distance to equilibrium the mean energy of a mode changes in an exchange with the relative
/// motion of two molecules, from near equilibrium.
///
/// An exchange draws the level anew from what both have, E: level v in proportion to (E - v k theta)^exponent. In
/// equilibrium the levels before and after are two draws for the same E, so the share is 1 - var(<v | E>) / var(v),
/// which depends on theta / T alone. At high temperatures it becomes a / (a + c), with a = exponent + 1 and the mode's
/// heat capacity c in units of k; at low ones that would be up to a quarter too large.
class RelaxingShare {
 public:
  /// `exponent`: half the degrees of freedom of relative motion in collisions, less 1; above -1.
  explicit RelaxingShare(double exponent);
  /// `ratio`: characteristic temperature over temperature, above 0. To 1e-4.
  double at(double ratio) const;

 private:
  double exponent_;
  std::vector<double> table_;
};

}  // namespace pamr::dsmc
