// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "pamr/par/comm.hpp"
#include "solvers/dsmc/gas/gas.hpp"
#include "solvers/dsmc/gas/stream.hpp"
#include "solvers/dsmc/kernel/boundary.hpp"
#include "solvers/dsmc/kernel/flux_tally.hpp"
#include "solvers/dsmc/kernel/gas_domain.hpp"
#include "solvers/dsmc/kernel/particles.hpp"
#include "solvers/dsmc/kernel/surface_tally.hpp"

namespace pamr::dsmc {

/// The gas that enters through a patch whose inflow follows the flow: Maxwellians, each of which moves along the inward
/// normal of the face.
struct EnteringGas {
  struct OfSpecies {
    double rate = 0;   ///< molecules per m2 and second that enter
    double speed = 0;  ///< m/s of the Maxwellian, into the gas
  };
  Stream gas;  ///< density, temperatures and fractions; without velocity
  std::vector<OfSpecies> species;
  double speed = 0;         ///< m/s into the gas, of the mean mass
  bool is_limited = false;  ///< the speed is that of sound: the flow asks for more
};

/// A patch of the kinds inlet and outlet. What passes it is averaged over the steps, each step with the weight
/// 1 / relaxation, and decides what enters in the next step:
///
/// - inlet: gas of its stream, which moves with the net mass flow over area and density. Its pressure is n k T.
/// - inlet with a mass flow: of each species what came out (averaged) and what the mass flow adds, at the speed at
///   which a Maxwellian of this density has this net flow.
/// - outlet: gas of the pressure of the condition; temperatures and fractions of the particles in the cells at the
///   patch, temperature from the motion along the patch; speed as for an inlet.
///
/// Speeds into the gas are at most that of sound. A Maxwellian on one side and the gas on the other have a pressure
/// that falls when gas enters faster than on average: waves are damped for every relaxation. Sums are integers over all
/// ranks, so that the same follows on any ranks. Source of the speed from the flux of particles: E. Farbar, I. D. Boyd,
/// "Subsonic flow boundary conditions for the direct simulation Monte Carlo method", Computers and Fluids 102 (2014).
class DrivenPatch {
 public:
  /// Units of the sums, and molecules per particle and second.
  struct Scale {
    double momentum_unit = 1, energy_unit = 1;  ///< of `SurfaceTally`
    double fnum_per_time = 1;
  };
  struct Kind {
    int patch = 0;
    BoundaryCondition condition;
    Stream stream;  ///< of an inlet its own; of an outlet the gas that is in the cells at it at the start
  };
  /// Starts with a gas at rest, or with the mass flow. Collective: one reduction for the area.
  DrivenPatch(const par::Comm& comm, const GasDomain& domain, const Gas& gas, const Kind& kind, const Scale& scale);

  int patch() const { return patch_; }
  const EnteringGas& entering() const { return entering_; }
  double sound() const;  ///< m/s, speed of sound in the gas that enters

  /// Before a step: notes the sums of the tally. Local.
  void begin_step(const FluxTally& flux);
  /// After it: appends what has passed on this rank since, and of an outlet what is in its cells (`n_words`). Local.
  void append_words(const FluxTally& flux, const Particles& particles, std::vector<std::int64_t>& words) const;
  std::size_t n_words() const { return mean_.size(); }
  /// Averages in the sums of all ranks. Local.
  void end_step(std::span<const std::int64_t> words);

  /// The averages so far, as checkpoints keep them.
  const std::vector<double>& means() const { return mean_; }
  /// The reverse. Throws `Error` for numbers that no averages are. Local.
  void set_means(std::span<const double> means);

 private:
  struct Cell {
    std::size_t cell = 0;
    Vec3 normal;
  };
  /// Places of the sums: out and in of each species; of an outlet also particles of each species, momentum along the
  /// patch (3), energy of the motion along it, of rotation, and in a gas that vibrates of vibration.
  std::size_t out(std::size_t s) const { return s; }
  std::size_t in(std::size_t s) const { return gas_->species.size() + s; }
  std::size_t count(std::size_t s) const { return 2 * gas_->species.size() + s; }
  std::size_t momentum() const { return 3 * gas_->species.size(); }
  void update();
  void take_gas_of_cells();
  void enter_at_pressure();
  void enter_at_mass_flow();
  double mass_of(const std::vector<double>& fraction) const;

  const Gas* gas_;
  int patch_;
  BoundaryCondition condition_;
  Scale scale_;
  double area_ = 0;         ///< m2
  std::vector<Cell> cell_;  ///< of this rank, at an outlet
  std::vector<std::int64_t> before_;
  std::vector<double> mean_;
  EnteringGas entering_;
};

}  // namespace pamr::dsmc
