// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/computation.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "pamr/balance/rebalance.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/base/with_file_name.hpp"
#include "solvers/dsmc/run/make_setup.hpp"
#include "solvers/dsmc/state/require_sound.hpp"

namespace pamr::dsmc {

namespace {

constexpr int steps_between_checks = 20;  ///< of the balance

/// What a cell with `n` particles costs in a step, in particles that only fly, from measurements: an empty cell half a
/// particle, a candidate pair somewhat less than one and more where many are compared for the nearest partner.
double cost_of(double n_candidates, std::uint32_t n) {
  constexpr std::uint32_t max_compared = 512;
  return 0.5 + n + n_candidates * (0.7 + 0.008 * std::min(n, max_compared));
}

}  // namespace

Computation::Computation(const par::Comm& comm, Case the_case, Setup setup, mesh::DistMesh given)
    : comm_(&comm), case_(std::move(the_case)), mesh_(std::move(given)), key_(key_of(comm, mesh_)) {
  flow_.emplace(comm, mesh_, std::move(setup));
  averaging_.emplace(case_, mesh_, *flow_);
}

void Computation::restart(const std::string& checkpoint) {
  const auto snapshot = read_checkpoint(*comm_, checkpoint, case_.gas);
  with_file_name(checkpoint, [&] { require_matching(snapshot, key_, *flow_); });
  require_sound(*comm_, checkpoint, snapshot, sound_range(*flow_));
  with_file_name(checkpoint, [&] { averaging_->resume(restore(*comm_, snapshot, *flow_)); });
  require_places(*comm_, checkpoint, *flow_);
}

Transferred Computation::transfer_from(const std::string& checkpoint) {
  const auto transferred = transfer_particles(*comm_, checkpoint, mesh_, *flow_);
  averaging_->begin_transferred(transferred.step);
  return transferred;
}

StepResult Computation::step(bool wants_stop) {
  averaging_->before_step(*flow_);
  const auto counts = flow_->step(wants_stop);
  averaging_->after_step(*flow_, counts.all);
  const StepResult result{is_complete(), counts.all.stop};
  computed_ += counts.compute_seconds;
  traffic_ += counts.traffic;
  if (!is_dynamic_ || comm_->size() == 1 || ++steps_ < steps_between_checks) return result;
  double longest = 0, mean = 0;
  for (const double one : comm_->all_gather(computed_ - std::exchange(checked_, computed_))) {
    longest = std::max(longest, one);
    mean += one / comm_->size();
  }
  if (rule_.add(std::exchange(steps_, 0), longest, mean) && !result.is_complete) rebalance();
  return result;
}

bool Computation::rebalance() {
  if (comm_->size() == 1) return false;
  const double start = wall_seconds();
  std::vector<double> weight;
  const auto begin = flow_->particles.begin();
  for (std::size_t c = 0; c + 1 < begin.size(); ++c) {
    const auto n = begin[c + 1] - begin[c];
    const bool collides = n > 1 && flow_->setup().collisions.enabled;
    weight.push_back(cost_of(collides ? mean_candidates(flow_->domain(), c, n, flow_->collisions[c]) : 0, n));
  }
  const auto snapshot = this->snapshot();
  balance::Options options;
  options.keep_below = 1.03;
  auto moved = balance::rebalance(*comm_, std::move(mesh_), weight, options);
  mesh_ = std::move(moved.mesh);
  const bool any = moved.report.moved_cells > 0;
  if (any) {
    auto setup = flow_->setup();
    setup.cell_dt = make_cell_dt(case_, mesh_, setup.unit);
    flow_.emplace(*comm_, mesh_, std::move(setup));
    averaging_->resume(restore(*comm_, snapshot, *flow_));
    ++n_moves_;
  }
  rule_.moved(comm_->max(wall_seconds() - start));
  return any;
}

}  // namespace pamr::dsmc
