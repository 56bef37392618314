// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solvers/dsmc/kernel/move.hpp"

namespace pamr::dsmc {

/// A particle of a stream's gas with velocity and rotation drawn; position, id and cell are not set.
Particle draw_particle(const Gas& gas, const Stream& stream, std::uint32_t species, Random& random);

/// Particles that come in through the boundary faces with an inflow condition during one time step, each with the time
/// that it has left. Number: the exact flux of a drifting Maxwellian through the face, rounded up or down at random so
/// that the mean is exact. Velocities: from the distribution of those that pass the face; uniform over face and time.
/// A face's particles depend on its cell's global number, its slot and the step alone. Ids are unique: bit 63, step
/// (25 bits), global face number (24 bits), number on the face (14 bits).
/// `first_face`: number of each boundary face of this rank among all inflow faces of the mesh (`number_inflow_faces`).
class Inflow {
 public:
  /// Collective: one exclusive sum in the order of the global cells. Throws `Error` when there are too many faces.
  Inflow(const par::Comm& comm, const MoveRules& rules, std::span<const Stream> stream);

  /// Appends to `entering`. Throws `Error` when more than 16,384 particles would come in through one face in a step.
  /// Local.
  void draw(std::uint64_t step, std::vector<Flight>& entering) const;

  /// Expected number of particles a step, on this rank.
  double expected() const;

 private:
  struct Face {
    std::size_t boundary = 0;
    std::uint64_t number = 0;
    std::vector<double> mean;  ///< particles a step, of each species
  };
  MoveRules rules_;
  std::vector<Stream> stream_;
  std::vector<Face> face_;
};

}  // namespace pamr::dsmc
