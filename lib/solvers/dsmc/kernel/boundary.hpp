// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>

#include "pamr/geometry/vec3.hpp"
#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/kernel/random.hpp"
#include "solvers/dsmc/kernel/vibrate.hpp"

namespace pamr::dsmc {

using geometry::Vec3;

/// What happens to particles that reach a patch of the boundary.
struct BoundaryCondition {
  enum class Kind : std::uint8_t {
    diffuse,   ///< re-emitted at the wall's temperature (Maxwell: the fraction `accommodation`, the rest specular)
    specular,  ///< reflected as by a mirror
    cll,       ///< Cercignani-Lampis-Lord reflection
    symmetry,  ///< reflected as by a mirror; not a wall: no load is counted
    inflow,    ///< removed; a stream's particles enter here
    outflow,   ///< removed: vacuum beyond
    inlet,     ///< removed; gas enters at the pressure of a stream, or as a mass flow (`DrivenPatch`)
    outlet,    ///< removed; gas enters at a pressure, with the temperature of the gas inside (`DrivenPatch`)
    periodic   ///< continues from the partner patch
  };
  Kind kind = Kind::specular;
  double temperature = 0;  ///< K
  Vec3 velocity{};         ///< m/s, of the wall, in its plane
  double accommodation = 1;
  double normal_accommodation = 1;       ///< cll: of the normal energy
  double tangential_accommodation = 1;   ///< cll: of the tangential momentum
  double rotational_accommodation = 1;   ///< cll: of the rotational energy
  int stream = -1;                       ///< inflow, inlet: index of the stream
  int partner = -1;                      ///< periodic: index of the other patch
  double pressure = 0;                   ///< outlet: Pa
  double mass_flow = 0;                  ///< inlet: kg/s through the patch; 0: as the pressure of the stream says
  double relaxation = 100;               ///< inlet, outlet: steps over which what passes the patch is averaged
  double vibrational_accommodation = 1;  ///< cll: of vibration: part of the molecules that take the wall's temperature

  bool is_wall() const { return kind == Kind::diffuse || kind == Kind::specular || kind == Kind::cll; }
  bool is_driven() const { return kind == Kind::inlet || kind == Kind::outlet; }
  bool brings_gas() const { return kind == Kind::inflow || is_driven(); }
  bool is_open() const { return kind == Kind::outflow || brings_gas(); }
};

/// A molecule's velocity, rotational energy and levels of vibration.
struct Motion {
  Vec3 velocity;
  double rotation = 0;
  std::uint32_t levels = 0;
};

inline double internal_energy(const Species& species, const Motion& m) {
  return internal_energy(species, m.rotation, m.levels);
}

/// Motion of a molecule after its reflection. `normal`: unit, out of the gas. Local.
Motion reflect(const BoundaryCondition& wall, const Species& species, Vec3 normal, const Motion& incident,
               Random& random);

/// Two unit vectors that form a right-handed orthonormal basis with a unit vector.
struct Tangents {
  Vec3 a, b;
};
/// Source: T. Duff et al., "Building an orthonormal basis, revisited", JCGT 6 (2017).
Tangents tangents(Vec3 n);

}  // namespace pamr::dsmc
