// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "pamr/base/exact.hpp"
#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"
#include "solvers/dsmc/kernel/nearest.hpp"
#include "solvers/dsmc/kernel/particles.hpp"
#include "solvers/dsmc/kernel/random.hpp"
#include "solvers/dsmc/kernel/section_bounds.hpp"
#include "solvers/dsmc/kernel/sub_cells.hpp"

namespace pamr::dsmc {

struct CollisionOptions {
  enum class Partner : std::uint8_t {
    nearest,  ///< the nearest particle of the cell with the exclusions that `Collider` describes
    subcell,  ///< one of its sub-cell with the same exclusions, where `SubCells` pay; elsewhere the nearest
    any       ///< any other particle of the cell
  };
  Exact<bool> enabled = true;
  Partner partner = Partner::nearest;
};

/// What a cell keeps between the collisions of one step and the next. Functions that carry it elsewhere (`CellRow`,
/// `transfer_particles`) name every member in a structured binding, so that a new one cannot be forgotten.
struct CellCollisions {
  double max_sigma_cr = 0;  ///< (sigma c_r)_max times weight, m3/s: a bound that grows when exceeded
  double remainder = 0;     ///< fraction of a candidate pair left over
  double temperature = 0;   ///< K, smoothed translational temperature for relaxation numbers that vary; 0: unset
  double separation = 0;    ///< m, summed over its collisions: distance of the two particles
  std::int64_t collisions = 0;
  double energy_deficit = 0;  ///< J times weight: lost by collisions of unlike weights, given back later
};

/// What happened in the collisions of a step on this rank.
struct CollisionCounts {
  std::int64_t candidates = 0;
  std::int64_t collisions = 0;
  std::int64_t clamped = 0;  ///< collisions whose relaxation probabilities were limited, to 1/2 a molecule and 1 in all
  void add(const CollisionCounts& other);
};

/// Candidate pairs of a cell with `n` particles in a step, remainders apart, on average.
inline double mean_candidates(const GasDomain& domain, std::size_t cell, std::uint32_t n, const CellCollisions& state) {
  return 0.5 * n * (n - 1.0) * domain.fnum[cell] * domain.dt[cell] / domain.volume[cell] * state.max_sigma_cr;
}

/// A remainder in (0, 1) from the random numbers of a global cell and step. With such a one at the start the number of
/// candidates is right on average from the first step on: the mean of floor(u + x) over u in (0, 1) is x.
double draw_remainder(std::uint64_t seed, GlobalId cell, std::uint64_t step);

/// Initial values for the given global cells of a gas at temperature `t`: the bound is that of a fast pair, the
/// remainder is drawn.
std::vector<CellCollisions> start_collisions(const Gas& gas, double t, std::uint64_t seed,
                                             std::span<const GlobalId> cells);

/// Collides the particles of every cell during a time step by the no-time-counter method.
///
/// - Candidates: N (N - 1) F_num (sigma c_r)_max dt / (2 V) pairs of a cell, the remainder kept for the next step; each
///   is accepted with probability sigma c_r / (sigma c_r)_max.
/// - Scattering: variable hard spheres (VHS) or variable soft spheres (VSS).
/// - Rotation: Larsen-Borgnakke exchange, with at most one of the two molecules per collision. Whether a candidate may
///   exchange is drawn before its partner is chosen.
/// - Vibration: the same draw decides whether instead one mode of one molecule exchanges (`vibration_chance`, by the
///   smoothed temperature of the cell): its level is drawn anew (`draw_level`), the rest is relative motion. The chance
///   does not depend on the pair's energy, so that equilibrium is kept.
/// - Partners that may exchange: the nearest one by position, except the one just tried in this step, whatever came of
///   the trial. This keeps the equilibrium of rotation and translation exact.
/// - Partners that may not exchange: the nearest one, except the particle's last collision partner, because a second
///   collision of the same pair changes nothing. Excluding it for all candidates would favor fast pairs, since slow
///   pairs stay together longer.
/// - `Partner::subcell`: a particle of the same sub-cell takes the place of the nearest, with the same exclusions.
/// - Order: random numbers belong to the global cell and the step, and a cell's particles are ordered by id, so the
///   result does not depend on the number of ranks.
/// - Conservation: momentum and energy of each pair to rounding.
///
/// Species of different weights (conservative weighting):
/// - A pair collides with the probability of the larger weight; a collision stands for as many real ones as the lighter
///   particle has molecules.
/// - The lighter particle takes the outcome. The heavier one gets the mean velocity and rotational energy of its two
///   parts, collided and not, which keeps the momentum, and the levels of one of them, drawn by their sizes.
/// - The energy lost thereby is the cell's `energy_deficit`. The particles of the largest weight present get it at
///   once, all by the same factor on their velocities about their mean: at most a quarter of their energy about it,
///   what is left waits for the next such collision. Energy plus deficit is kept to rounding.
///
/// Source: G. A. Bird, Molecular Gas Dynamics and the Direct Simulation of Gas Flows, 1994, chapters 11 and 5; I. D.
/// Boyd, "Conservative species weighting scheme for the direct simulation Monte Carlo method", J. Thermophys. Heat
/// Transfer 10 (1996).
class Collider {
 public:
  Collider(const Gas& gas, const CollisionOptions& options, std::uint64_t seed);

  /// One time step of all cells. `particles` must be sorted by cell. Local. O(particles + candidates), with weights
  /// O(particles + candidates x particles a cell).
  CollisionCounts collide(const GasDomain& domain, std::uint64_t step, Particles& particles,
                          std::vector<CellCollisions>& state);
  /// Collisions between species a <= b since construction, on this rank, at index a * n_species + b.
  std::span<const std::int64_t> collisions_of_pairs() const { return of_pair_; }

 private:
  void collide_cell(const GasDomain& domain, std::size_t c, std::uint64_t step, Particles& particles,
                    CellCollisions& state);
  bool is_accepted(std::size_t pair, double speed_squared, double threshold, double& max_sigma_cr) const;
  /// The particles of a cell: `n` rows from `begin` on.
  struct Rows {
    std::uint32_t begin = 0, n = 0;
  };
  std::uint32_t choose_partner(const Particles& particles, Rows cell, std::uint32_t first, std::uint32_t excluded,
                               Random& random);
  /// The nearest particle of a species that is drawn in proportion to its particles.
  std::uint32_t choose_weighted_partner(const Particles& particles, Rows cell, std::uint32_t first,
                                        std::uint32_t excluded, Random& random);
  struct Partners {
    std::uint32_t a = 0, b = 0;
    double speed_squared = 0;  ///< of their relative motion
    double draw = 1;           ///< in (0, 1): small ones exchange internal energy
  };
  void collide_pair(Particles& particles, const Partners& partners, double temperature, Random& random);
  void collide_weighted(Particles& particles, Partners partners, CellCollisions& state, Random& random);
  /// Gives the energy deficit of a cell to its particles of the largest weight.
  void give_back(Particles& particles, Rows cell, double heaviest, double& deficit) const;
  /// Chances of all modes in gas of a temperature.
  void set_vibration_chances(double temperature);
  /// Of a molecule of species a against one of species b, in all.
  double vibration_chance_of(std::size_t a, std::size_t b) const;
  /// A mode of one of the pair, chosen by `draw` (from 0 to the sum of the chances of both), exchanges with the
  /// relative motion, which has the energy `motion` (J). Returns what that has afterwards.
  double exchange_vibration(Particles& particles, const Partners& partners, double draw, double motion, Random& random);

  const Gas* gas_;
  CollisionOptions options_;
  std::uint64_t seed_;
  CollisionCounts counts_;
  std::vector<std::int64_t> of_pair_;
  std::vector<SectionBounds> bounds_;  ///< of the gas's pairs
  /// Of each particle of the cell: tag of its partner in the last candidate pair of this step that might exchange.
  std::vector<std::uint32_t> last_candidate_;
  double max_exchange_ = 0;  ///< largest chance of an exchange of internal energy in the current cell, at most 1
  /// Of an exchange, by pair of species (that of the mode first) and mode, `max_modes` of them; empty: no vibration.
  std::vector<double> vibration_chance_;
  NearestInCell nearest_;
  SubCells sub_cells_;
  bool has_sub_cells_ = false;  ///< the current cell
};

}  // namespace pamr::dsmc
