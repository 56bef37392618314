// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solvers/dsmc/gas/stream.hpp"
#include "solvers/dsmc/kernel/move.hpp"

namespace pamr::dsmc {

/// A particle of a stream with random velocity and rotational energy; position, id and cell are not set. Local.
Particle draw_particle(const Gas& gas, const Stream& stream, std::uint32_t species, Random& random);

/// The particles that enter through boundary faces with an inflow condition during a time step.
///
/// - Number: the flux of a drifting Maxwellian through the face, rounded at random so that the mean is exact.
/// - Velocities: from the distribution of the molecules that pass the face; uniform over face and time.
/// - A face's particles depend only on its cell's global number, its slot and the step, not on the ranks.
/// - Ids are unique: bit 63, step (25 bits), global number of the inflow face (24 bits), number on the face (14 bits).
class Inflow {
 public:
  /// Collective: one exclusive sum in the order of the global cells. Throws `Error` on every rank when there are too
  /// many faces, or more particles a step than can be numbered or held.
  Inflow(const par::Comm& comm, const MoveRules& rules, std::span<const Stream> stream);

  /// Appends the particles of a step to `entering`, each with the time that it has left, and adds them to `flux`
  /// (null: not counted). Local. Throws `Error` when more than 16,384 would enter through one face.
  void draw(std::uint64_t step, std::vector<Flight>& entering, FluxTally* flux = nullptr) const;

  /// Expected number of particles per step on this rank. Local.
  double expected() const;

 private:
  struct Face {
    std::size_t boundary = 0;
    std::uint64_t number = 0;
    std::vector<double> mean;  ///< particles per step, of each species
  };
  void require_feasible(const par::Comm& comm) const;
  [[noreturn]] void refuse(const Face& face) const;

  MoveRules rules_;
  std::vector<Stream> stream_;
  std::vector<Face> face_;
};

}  // namespace pamr::dsmc
