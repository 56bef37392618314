// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pamr::poisson_boltzmann {

/// Potential in front of one infinite plate of constant potential in contact with a reservoir, exactly:
/// tanh(psi/4) = tanh(psi_s/4) exp(-z), or psi_s exp(-z) where the equation is linear. Lengths in Debye lengths from
/// the plate, which lies at `position`; the liquid is where z is greater, and below it the plate's values hold. Source:
/// G. Gouy, J. Phys. Theor. Appl. 9 (1910); D. L. Chapman, Phil. Mag. 25 (1913).
///
/// Every term is positive where the equation is not linear, so no digits cancel at any potential: with t = exp(-z) and
/// q = exp(-|psi_s|/2), |psi| = 2 log(N/D), N = (1 + t) + q (1 - t), D = (1 - t) + q (1 + t).
class PlateProfile {
 public:
  PlateProfile() = default;
  PlateProfile(double potential, double position, bool linear);

  /// psi0(z).
  double potential(double z) const;
  /// dpsi0/dz; -2 sinh(psi0/2) where the equation is not linear.
  double slope(double z) const;
  /// Mean of the slope between two heights, in either order: bounded where the slope at the plate is not.
  double mean_slope(double z, double other) const;
  /// A height with the potential there.
  struct Place {
    double z, potential;
  };
  /// The same where the potentials are known: some ten times as fast.
  double mean_slope(const Place& a, const Place& b) const;

 private:
  struct Terms {
    double decay;        ///< t
    double numerator;    ///< N
    double denominator;  ///< D
  };
  Terms terms(double z) const;

  double potential_ = 0;  ///< psi_s
  double small_ = 1;      ///< q
  double position_ = 0;
  bool linear_ = true;
};

}  // namespace pamr::poisson_boltzmann
