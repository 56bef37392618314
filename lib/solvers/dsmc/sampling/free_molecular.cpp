// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/sampling/free_molecular.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "pamr/base/index.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

const double root_pi = std::sqrt(std::numbers::pi);

/// Integrals of u^k exp(-(u - s)^2) / sqrt(pi) over u > 0 for k = 1, 2, 3: molecules, normal momentum and normal energy
/// that pass a plane towards which the gas moves with speed ratio s.
struct Passing {
  explicit Passing(double s)
      : molecules(flux_factor(s) / (2 * root_pi)),
        momentum(s * molecules + 0.25 * std::erfc(-s)),
        energy(s * momentum + molecules) {}
  double molecules, momentum, energy;
};

/// Molecules of one species that reach a face, as the wall sees them, per area and time.
struct Incident {
  double mass = 0;
  double molecules = 0;
  Vec3 along;                                               ///< m/s, mean velocity in the face's plane
  double pressure = 0;                                      ///< Pa, of the normal momentum
  double normal_energy = 0, flat_energy = 0, rotation = 0;  ///< W/m2
  double vibration = 0;                                     ///< W/m2
  double density = 0, speed = 0, speed_ratio = 0;           ///< 1/m3; m/s, most probable; of the normal velocity
};

Incident incident_on(const BoundaryCondition& wall, Vec3 normal, const Species& species, double fraction,
                     const Stream& stream) {
  Incident in;
  in.mass = species.mass;
  in.density = fraction * stream.density;
  in.speed = most_probable_speed(stream.temperature, species.mass);
  const Vec3 relative = stream.velocity - wall.velocity;
  const double towards = dot(relative, normal), c = in.speed;
  in.speed_ratio = towards / c;
  in.along = relative - towards * normal;
  const Passing passing(in.speed_ratio);
  in.molecules = in.density * c * passing.molecules;
  in.pressure = in.mass * in.density * c * c * passing.momentum;
  in.normal_energy = 0.5 * in.mass * in.density * c * c * c * passing.energy;
  in.flat_energy = 0.5 * in.mass * in.molecules * (squared_norm(in.along) + c * c);
  in.rotation = 0.5 * species.rotational_degrees * boltzmann * stream.rotational_temperature * in.molecules;
  in.vibration = boltzmann * mean_vibrational_energy(species.vibration, stream.vibrational_temperature) * in.molecules;
  return in;
}

/// The integral of u exp(-(u - s)^2) / sqrt(pi) times the mean normal speed with which a molecule of normal speed u
/// leaves a wall of kind cll, u in units of `ratio` times the unit of the latter, sqrt(2 k T_w / m).
///
/// That speed is the length of a vector Z of the plane, which is normal about sqrt(1 - alpha) u with the variance alpha
/// / 2 of each component. From E|Z| = 1 / sqrt(pi) times the integral of (1 - E exp(-x^2 |Z|^2)) / x^2 over x > 0,
/// where the expectation over Z, and then the integral over u, are closed forms. With x ~ tan(angle) the integrand is
/// smooth and periodic, so that few midpoints suffice: 1e-7 of the largest value, most of it where alpha is 0.
double leaving_speed(double s, double ratio, double alpha) {
  constexpr int n_points = 48;
  constexpr double step = std::numbers::pi / 2 / n_points;
  const double kept = (1 - alpha) * ratio * ratio, front = std::max(s, 0.0);
  const double scale = 1 / std::sqrt(kept * (front * front + 1.5) + alpha);
  const double all = Passing(s).molecules;
  double sum = 0;
  for (int i = 0; i < n_points; ++i) {
    const double angle = (i + 0.5) * step, x = scale * std::tan(angle), spread = 1 + alpha * x * x;
    const double b = 1 + kept * x * x / spread;
    const double expected = std::exp(-s * s * (1 - 1 / b)) * Passing(s / std::sqrt(b)).molecules / (b * spread);
    const double sine = std::sin(angle);
    sum += (all - expected) / (sine * sine);
  }
  return sum * step / (root_pi * scale);
}

/// Pressure of the molecules that leave, shear and heat flux.
struct Effect {
  double pressure = 0;
  Vec3 shear;
  double heat = 0;
};

Effect effect_on(const BoundaryCondition& wall, const Species& species, const Incident& in) {
  using Kind = BoundaryCondition::Kind;
  if (wall.kind != Kind::diffuse && wall.kind != Kind::cll) return {in.pressure, {}, 0};
  const double c = most_probable_speed(wall.temperature, species.mass);
  const double emitted = boltzmann * wall.temperature * in.molecules;  // energy of one direction's motion
  const double rotation = 0.5 * species.rotational_degrees * emitted;
  const double vibration = boltzmann * mean_vibrational_energy(species.vibration, wall.temperature) * in.molecules;
  const Vec3 flat = (in.mass * in.molecules) * in.along;
  if (wall.kind == Kind::diffuse) {
    const double a = wall.accommodation;
    return {
        (1 - a) * in.pressure + a * in.mass * in.molecules * 0.5 * root_pi * c, a * flat,
        a * (in.normal_energy + in.flat_energy - 2 * emitted + in.rotation - rotation + (in.vibration - vibration))};
  }
  const double normal = wall.normal_accommodation, sigma = wall.tangential_accommodation;
  return {in.mass * in.density * in.speed * c * leaving_speed(in.speed_ratio, in.speed / c, normal), sigma * flat,
          normal * (in.normal_energy - emitted) + sigma * (2 - sigma) * (in.flat_energy - emitted) +
              wall.rotational_accommodation * (in.rotation - rotation) +
              wall.vibrational_accommodation * (in.vibration - vibration)};
}

}  // namespace

SurfaceLaw free_molecular_law(const Gas& gas, const Stream& stream, std::vector<BoundaryCondition> walls) {
  return [=, walls = std::move(walls)](const BoundaryFace& face) -> std::pair<Vec3, double> {
    const auto& wall = walls[at(face.patch)];
    Vec3 stress;
    double heat = 0;
    if (!wall.is_wall()) return {stress, heat};
    for (std::size_t s = 0; s < gas.species.size(); ++s) {
      const auto in = incident_on(wall, face.normal, gas.species[s], stream.fraction[s], stream);
      const auto effect = effect_on(wall, gas.species[s], in);
      stress = stress + (in.pressure + effect.pressure) * face.normal + effect.shear;
      heat += effect.heat;
    }
    return {stress, heat};
  };
}

bool leaves_its_plane(const BoundaryCondition& wall, Vec3 normal, double allowed) {
  return std::fabs(dot(wall.velocity, normal)) > allowed * norm(wall.velocity);
}

}  // namespace pamr::dsmc
