// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"
#include "solvers/dsmc/kernel/nearest.hpp"
#include "solvers/dsmc/kernel/particles.hpp"
#include "solvers/dsmc/kernel/random.hpp"

namespace pamr::dsmc {

struct CollisionOptions {
  enum class Partner : std::uint8_t {
    nearest,  ///< the nearest particle of the cell; not the last partner where no rotational energy may be exchanged
    any       ///< any other particle of the cell
  };
  bool enabled = true;
  Partner partner = Partner::nearest;
};

/// What the collisions of a cell carry from step to step.
struct CellCollisions {
  double greatest = 0;     ///< (weight times cross section times speed)_max, m3/s: a bound that grows when exceeded
  double remainder = 0;    ///< part of a candidate pair left over
  double temperature = 0;  ///< smoothed translational temperature, for the variable relaxation number; 0: not yet
  double separation = 0;   ///< sum over its collisions of the distance of the two particles, m
  std::int64_t collisions = 0;
  double owed = 0;  ///< energy that collisions of unlike weights have taken, to be given back: J times weight
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
/// with at most one partner a collision. Whether a candidate pair may exchange is drawn before its partners. Pairs that
/// may are chosen by their places alone (of the nearest ones not the one just tried in this step), whatever came of
/// earlier trials: so the equilibrium of rotation and translation stays exactly. Of the others, which keep their
/// relative speed, the last partner is barred, since to meet again at once does nothing. To bar it for all would select
/// pairs by their relative speed, because slow pairs stay together for longer. The numbers drawn belong to the global
/// cell and the step, the particles of a cell are in the order of their ids: the result does not depend on the number
/// of ranks. Momentum and energy of each pair are kept to rounding. Local. O(particles + candidates), with weights
/// O(particles + candidates x particles a cell).
///
/// Species of unlike weights: a pair collides with the chance of the greater weight, so that each collision stands for
/// as many of real ones as the lighter particle has molecules. The lighter one takes the outcome; of the heavier one
/// only the part of the weights' ratio does, and it then gets the mean velocity and mean rotational energy of its two
/// parts. That keeps the momentum. The energy that the mean loses is owed by the cell and goes into the relative motion
/// of its next collision of two particles of the greatest weight present: energy with what is owed is kept to rounding.
/// Source: G. A. Bird, Molecular Gas Dynamics and the Direct Simulation of Gas Flows, 1994, chapters 11 and 5; I. D.
/// Boyd, "Conservative species weighting scheme for the direct simulation Monte Carlo method", J. Thermophys. Heat
/// Transfer 10 (1996).
class Collider {
 public:
  Collider(const Gas& gas, const CollisionOptions& options, std::uint64_t seed)
      : gas_(&gas), options_(options), seed_(seed), of_pair_(gas.pairs.size(), 0) {}

  CollisionCounts collide(const Domain& domain, std::uint64_t step, Particles& particles,
                          std::vector<CellCollisions>& state);
  /// Collisions of particles of species a and b since this was made, at a n_species + b with a <= b; of this rank.
  std::span<const std::int64_t> collisions_of_pairs() const { return of_pair_; }

 private:
  void collide_cell(const Domain& domain, std::size_t c, std::uint64_t step, Particles& particles,
                    CellCollisions& state);
  std::uint32_t choose_partner(const Particles& particles, std::uint32_t begin, std::uint32_t n, std::uint32_t first,
                               std::uint32_t barred, Random& random);
  /// The nearest of a species drawn with the chance of its particles.
  std::uint32_t choose_weighted_partner(const Particles& particles, std::uint32_t begin, std::uint32_t n,
                                        std::uint32_t first, std::uint32_t barred, Random& random);
  struct Partners {
    std::uint32_t a = 0, b = 0;
    double speed_squared = 0;  ///< of their relative motion
    double draw = 1;           ///< in (0, 1): small ones exchange rotational energy
  };
  void collide_pair(Particles& particles, const Partners& partners, double temperature, Random& random);
  void collide_weighted(Particles& particles, Partners partners, double heaviest, CellCollisions& state,
                        Random& random);

  const Gas* gas_;
  CollisionOptions options_;
  std::uint64_t seed_;
  CollisionCounts counts_;
  std::vector<std::int64_t> of_pair_;
  std::vector<std::uint32_t> tried_;  ///< tag of the last partner in the cell and step in a pair that may exchange
  double exchanging_ = 0;             ///< greatest chance of an exchange of rotational energy, in the cell at hand
  NearestInCell nearest_;
};

}  // namespace pamr::dsmc
