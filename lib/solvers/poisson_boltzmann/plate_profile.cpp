// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/plate_profile.hpp"

#include <cmath>

namespace pamr::poisson_boltzmann {

PlateProfile::PlateProfile(double potential, double position, bool linear)
    : amplitude_(linear ? potential : std::tanh(potential / 4)), position_(position), linear_(linear) {}

double PlateProfile::potential(double z) const {
  const double decayed = amplitude_ * std::exp(position_ - z);
  return linear_ ? decayed : 4 * std::atanh(decayed);
}

double PlateProfile::slope(double z) const { return linear_ ? -potential(z) : -2 * std::sinh(potential(z) / 2); }

}  // namespace pamr::poisson_boltzmann
