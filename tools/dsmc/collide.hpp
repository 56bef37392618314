// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "dsmc/domain.hpp"
#include "dsmc/gas.hpp"
#include "dsmc/particles.hpp"
#include "dsmc/random.hpp"

namespace pamr::dsmc {

struct CollisionOptions {
  enum class Partner : std::uint8_t {
    nearest,  ///< the nearest particle of the cell but the one with which the first has last collided
    any       ///< any other particle of the cell
  };
  bool enabled = true;
  Partner partner = Partner::nearest;
};

/// What the collisions of a cell carry from step to step.
struct CellCollisions {
  double greatest = 0;     ///< (cross section times speed)_max, m3/s: a bound that grows when it is exceeded
  double remainder = 0;    ///< part of a candidate pair left over
  double temperature = 0;  ///< smoothed translational temperature, for the variable relaxation number; 0: not yet
  double separation = 0;   ///< sum over its collisions of the distance of the two particles, m
  std::int64_t collisions = 0;
};

/// What happened in the collisions of a step on this rank.
struct CollisionCounts {
  std::int64_t candidates = 0;
  std::int64_t collisions = 0;
  std::int64_t clamped = 0;  ///< collisions whose relaxation probability was cut to 1/2
  void add(const CollisionCounts& other);
};

/// Start values for cells in a gas of temperature `t`: the cross section times speed of a fast pair.
std::vector<CellCollisions> start_collisions(const Gas& gas, double t, std::size_t n_cells);

/// Collides the particles of every cell for one time step. `particles` must be sorted by cell.
///
/// No time counter: candidate pairs N (N - 1) F (sigma c)_max dt / (2 V) with the remainder carried, each accepted with
/// sigma c / (sigma c)_max. Scattering by variable hard or soft spheres; Larsen-Borgnakke exchange of rotational energy
/// with at most one partner a collision. The numbers drawn belong to the global cell and the step, the particles of a
/// cell are in the order of their ids: the result does not depend on the number of ranks. Momentum and energy of each
/// pair are kept to rounding. Local. O(particles + candidates x particles a cell).
/// Source: G. A. Bird, Molecular Gas Dynamics and the Direct Simulation of Gas Flows, 1994, chapters 11 and 5.
class Collider {
 public:
  Collider(const Gas& gas, const CollisionOptions& options, std::uint64_t seed)
      : gas_(&gas), options_(options), seed_(seed) {}

  CollisionCounts collide(const Domain& domain, std::uint64_t step, Particles& particles,
                          std::vector<CellCollisions>& state);

 private:
  void collide_cell(const Domain& domain, std::size_t c, std::uint64_t step, Particles& particles,
                    CellCollisions& state);
  std::uint32_t choose_partner(const Particles& particles, std::uint32_t begin, std::uint32_t n, std::uint32_t first,
                               Random& random);
  void collide_pair(Particles& particles, std::uint32_t a, std::uint32_t b, double speed_squared, double temperature,
                    Random& random);

  const Gas* gas_;
  CollisionOptions options_;
  std::uint64_t seed_;
  CollisionCounts counts_;
};

}  // namespace pamr::dsmc
