// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/kernel/boundary.hpp"

#include <cmath>
#include <numbers>

namespace pamr::dsmc {

using namespace geometry;

namespace {

Motion mirror(Vec3 normal, const Motion& in) {
  return {in.velocity - (2 * dot(in.velocity, normal)) * normal, in.rotation, in.levels};
}

/// Half a Maxwellian at the wall's temperature.
Motion emit(const BoundaryCondition& wall, const Species& species, Vec3 normal, Random& random) {
  const double c = std::sqrt(2 * boltzmann * wall.temperature / species.mass);
  const double away = c * std::sqrt(-std::log(random.uniform()));
  const auto [p, q] = random.normal_pair();
  const auto [a, b] = tangents(normal);
  const double along = c * std::numbers::sqrt2 / 2;
  Motion out;
  out.velocity = (-away) * normal + (along * p) * a + (along * q) * b + wall.velocity;
  out.rotation = boltzmann * wall.temperature * random.thermal_energy(species.rotational_degrees);
  out.levels = thermal_levels(species.vibration, wall.temperature, random);
  return out;
}

/// A component of length `in` that is accommodated by the part `alpha`, units of sqrt(2 k T_w / m): its parts along and
/// across the old direction.
struct Component {
  double along = 0, across = 0;
};
Component accommodate(double in, double alpha, Random& random) {
  const double r = std::sqrt(-alpha * std::log(random.uniform()));
  const double angle = 2 * std::numbers::pi * random.uniform();
  return {std::sqrt(1 - alpha) * in + r * std::cos(angle), r * std::sin(angle)};
}

/// Source: R. G. Lord, "Some extensions to the Cercignani-Lampis gas-surface scattering kernel", Phys. Fluids A 3
/// (1991).
Motion scatter(const BoundaryCondition& wall, const Species& species, Vec3 normal, const Motion& in, Random& random) {
  const double c = std::sqrt(2 * boltzmann * wall.temperature / species.mass);
  const Vec3 relative = (1 / c) * (in.velocity - wall.velocity);
  const double towards = dot(relative, normal);
  const Vec3 flat = relative - towards * normal;
  const double speed = norm(flat);
  const Vec3 along = speed > 0 ? (1 / speed) * flat : tangents(normal).a;
  const double sigma = wall.tangential_accommodation;
  const auto n = accommodate(towards, wall.normal_accommodation, random);
  const auto t = accommodate(speed, sigma * (2 - sigma), random);
  const double away = std::sqrt(n.along * n.along + n.across * n.across);
  Motion out;
  out.velocity = c * ((-away) * normal + t.along * along + t.across * cross(normal, along)) + wall.velocity;
  if (species.rotational_degrees == 2) {
    const double energy = boltzmann * wall.temperature;
    const auto r = accommodate(std::sqrt(in.rotation / energy), wall.rotational_accommodation, random);
    out.rotation = energy * (r.along * r.along + r.across * r.across);
  } else if (random.uniform() < wall.rotational_accommodation) {
    out.rotation = boltzmann * wall.temperature * random.thermal_energy(species.rotational_degrees);
  } else {
    out.rotation = in.rotation;
  }
  out.levels = in.levels;
  if (!species.vibration.mode.empty() && random.uniform() < wall.vibrational_accommodation)
    out.levels = thermal_levels(species.vibration, wall.temperature, random);
  return out;
}

}  // namespace

Tangents tangents(Vec3 n) {
  const double sign = std::copysign(1.0, n.z);
  const double a = -1 / (sign + n.z), b = n.x * n.y * a;
  return {{1 + sign * n.x * n.x * a, sign * b, -sign * n.x}, {b, sign + n.y * n.y * a, -n.y}};
}

Motion reflect(const BoundaryCondition& wall, const Species& species, Vec3 normal, const Motion& incident,
               Random& random) {
  using Kind = BoundaryCondition::Kind;
  if (wall.kind == Kind::cll) return scatter(wall, species, normal, incident, random);
  if (wall.kind != Kind::diffuse) return mirror(normal, incident);
  if (wall.accommodation < 1 && random.uniform() >= wall.accommodation) return mirror(normal, incident);
  return emit(wall, species, normal, random);
}

}  // namespace pamr::dsmc
