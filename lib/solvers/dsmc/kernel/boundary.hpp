// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/geometry/vec3.hpp"
#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/kernel/random.hpp"

namespace pamr::dsmc {

using geometry::Vec3;

/// A gas far away or at the start: uniform, its rotation at a temperature of its own.
struct Stream {
  std::string name;
  double density = 0;      ///< molecules per m3
  double temperature = 0;  ///< K
  double rotational_temperature = 0;
  Vec3 velocity;                 ///< m/s
  std::vector<double> fraction;  ///< of the species; sum 1
};

/// What a patch of the boundary does to particles that reach it.
struct BoundaryCondition {
  enum class Kind : std::uint8_t {
    diffuse,   ///< leaves with the wall's temperature (parts `accommodation` of the molecules; the rest is mirrored)
    specular,  ///< mirrored
    cll,       ///< Cercignani, Lampis and Lord
    symmetry,  ///< mirrored; not a wall: no force is counted
    inflow,    ///< a stream comes in; what reaches it leaves
    outflow,   ///< vacuum beyond: what reaches it leaves
    periodic   ///< what reaches it goes on from the partner patch
  };
  Kind kind = Kind::specular;
  double temperature = 0;  ///< K
  Vec3 velocity;           ///< of the wall, in its plane
  double accommodation = 1;
  double normal_accommodation = 1;      ///< cll: of the normal energy
  double tangential_accommodation = 1;  ///< cll: of the tangential momentum
  double rotational_accommodation = 1;  ///< cll: of the rotational energy
  int stream = -1;                      ///< inflow: which
  int partner = -1;                     ///< periodic: the other patch

  bool is_wall() const { return kind == Kind::diffuse || kind == Kind::specular || kind == Kind::cll; }
  bool is_open() const { return kind == Kind::inflow || kind == Kind::outflow; }
};

/// A molecule's velocity and rotational energy.
struct Motion {
  Vec3 velocity;
  double rotation = 0;
};

/// How a molecule leaves a wall, a specular plane included. `normal`: unit, out of the gas.
Motion reflect(const BoundaryCondition& wall, const Species& species, Vec3 normal, const Motion& incident,
               Random& random);

/// Two unit vectors that make a right-handed orthonormal system with unit vector `n`.
/// Source: T. Duff et al., "Building an orthonormal basis, revisited", JCGT 6 (2017).
struct Tangents {
  Vec3 a, b;
};
Tangents tangents(Vec3 n);

}  // namespace pamr::dsmc
