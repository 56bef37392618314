// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

namespace pamr::poisson_boltzmann {

/// Potential in front of one infinite plate of constant potential in contact with a reservoir, exactly:
/// tanh(psi/4) = tanh(psi_s/4) exp(-z), or psi_s exp(-z) where the equation is linear. Lengths in Debye lengths from
/// the plate, which lies at `position`; the liquid is where z is greater. Source: G. Gouy, J. Phys. Theor. Appl. 9
/// (1910); D. L. Chapman, Phil. Mag. 25 (1913).
class PlateProfile {
 public:
  PlateProfile() = default;
  PlateProfile(double potential, double position, bool linear);

  /// psi0(z).
  double potential(double z) const;
  /// dpsi0/dz; -2 sinh(psi0/2) where the equation is not linear.
  double slope(double z) const;

 private:
  double amplitude_ = 0;  ///< tanh(psi_s/4), or psi_s
  double position_ = 0;
  bool linear_ = true;
};

}  // namespace pamr::poisson_boltzmann
