// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/problem/plate_profile.hpp"

#include <algorithm>
#include <cmath>

namespace pamr::poisson_boltzmann {

PlateProfile::PlateProfile(double potential, double position, bool linear)
    : potential_(potential), small_(std::exp(-std::abs(potential) / 2)), position_(position), linear_(linear) {}

PlateProfile::Terms PlateProfile::terms(double z) const {
  const double height = std::max(0.0, z - position_);
  const double t = std::exp(-height), rest = -std::expm1(-height);  // 1 - t without cancellation
  return {t, (1 + t) + small_ * rest, rest + small_ * (1 + t)};
}

double PlateProfile::potential(double z) const {
  if (linear_) return potential_ * std::exp(-std::max(0.0, z - position_));
  const auto [t, numerator, denominator] = terms(z);
  const double difference = -2 * t * std::expm1(-std::abs(potential_) / 2);  // N - D
  return std::copysign(2 * std::log1p(difference / denominator), potential_);
}

double PlateProfile::slope(double z) const {
  if (linear_) return -potential(z);
  const auto [t, numerator, denominator] = terms(z);
  const double product = -2 * t * std::expm1(-std::abs(potential_));  // (N - D)(N + D) / 2
  return -std::copysign(2 * product / (numerator * denominator), potential_);
}

double PlateProfile::mean_slope(double z, double other) const {
  return mean_slope({z, potential(z)}, {other, potential(other)});
}

double PlateProfile::mean_slope(const Place& a, const Place& b) const {
  const double difference = b.z - a.z;
  // Over a thousandth of a Debye length the slope at the middle is as good, and nothing cancels.
  const double thin = std::abs(difference);
  if (thin <= 1e-3 * std::min(1.0, std::max(0.0, std::min(a.z, b.z) - position_))) return slope(a.z + difference / 2);
  return (b.potential - a.potential) / difference;
}

}  // namespace pamr::poisson_boltzmann
