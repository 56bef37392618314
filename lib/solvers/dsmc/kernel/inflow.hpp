// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solvers/dsmc/gas/stream.hpp"
#include "solvers/dsmc/kernel/driven_patch.hpp"
#include "solvers/dsmc/kernel/move.hpp"

namespace pamr::dsmc {

/// A particle of a stream with random velocity, rotation and vibration; position, id and cell are not set. Local.
Particle draw_particle(const Gas& gas, const Stream& stream, std::uint32_t species, Random& random);

/// The particles that enter through boundary faces during a time step: with the condition inflow from a stream, of
/// inlets and outlets as their `DrivenPatch` says at the time.
///
/// - Number: the flux of a drifting Maxwellian through the face, rounded at random so that the mean is exact.
/// - Velocities: from the distribution of the molecules that pass the face; uniform over face and time.
/// - A face's particles depend only on its cell's global number, its slot and the step, not on the ranks.
/// - Ids are unique: bit 63, step (25 bits), global number of the inflow face (24 bits), number on the face (14 bits).
class Inflow {
 public:
  /// Collective: one exclusive sum in the order of the global cells. Throws `Error` on every rank when there are too
  /// many faces, or more particles a step than can be numbered or held.
  Inflow(const par::Comm& comm, const MoveRules& rules, std::span<const Stream> stream,
         std::span<const DrivenPatch> driven = {});

  /// Appends the particles of a step to `entering`, each with the time that it has left, and adds them to `flux`
  /// (null: not counted). `driven`: all inlets and outlets, in the order of the constructor. Local. Throws `Error` when
  /// more than 16,384 would enter through one face.
  void draw(std::uint64_t step, std::vector<Flight>& entering, FluxTally* flux = nullptr,
            std::span<const DrivenPatch> driven = {}) const;

  /// Expected number of particles per step on this rank. Local.
  double expected(std::span<const DrivenPatch> driven = {}) const;

 private:
  struct Face {
    std::size_t boundary = 0;
    std::uint64_t number = 0;
    int driven = -1;           ///< index of the driven patch; -1: a stream enters
    std::vector<double> mean;  ///< particles per step, of each species; driven: per molecule per m2 and second
  };
  void require_feasible(const par::Comm& comm, std::span<const DrivenPatch> driven) const;
  static double mean_of(const Face& face, std::size_t species, std::span<const DrivenPatch> driven);
  [[noreturn]] void refuse(const Face& face) const;

  MoveRules rules_;
  std::vector<Stream> stream_;
  std::vector<Face> face_;
};

}  // namespace pamr::dsmc
