// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/computation.hpp"

#include <utility>
#include <vector>

#include "pamr/balance/rebalance.hpp"
#include "pamr/base/timer.hpp"

namespace pamr::dsmc {

namespace {

constexpr int steps_of_a_look = 20;
constexpr double weight_of_a_cell = 0.5;  ///< of a particle: what an empty cell costs in a step

}  // namespace

bool StopAtRise::add(double n_steps, double longest, double mean) {
  lost_ += longest - mean;
  steps_ += n_steps;
  const double now = (lost_ + price_) / steps_;
  const bool rises = last_ >= 0 && now > last_;
  last_ = now;
  return rises;
}

void StopAtRise::moved(double price) {
  *this = {};
  price_ = price;
}

Computation::Computation(const par::Comm& comm, const Case& the_case, mesh::DistMesh given)
    : mesh(std::move(given)), comm_(&comm), case_(&the_case), key_(key_of(comm, mesh)) {
  make();
}

void Computation::make() {
  run.reset();
  flow.reset();
  flow = std::make_unique<Flow>(*comm_, mesh, make_setup(*comm_, *case_, mesh));
  run = std::make_unique<Run>(*case_, mesh, *flow);
}

bool Computation::step() {
  const bool complete = run->step();
  computed_ += run->last_step().compute_seconds;
  if (comm_->size() == 1 || ++steps_ < steps_of_a_look) return complete;
  const double longest = comm_->max(computed_);
  double mean = 0;
  for (const double one : comm_->all_gather(computed_)) mean += one / comm_->size();
  if (rule_.add(std::exchange(steps_, 0), longest, mean) && !complete) rebalance();
  computed_ = 0;
  return complete;
}

bool Computation::rebalance() {
  if (comm_->size() == 1) return false;
  const double start = wall_seconds();
  std::vector<double> weight;
  const auto begin = flow->particles.begin();
  for (std::size_t c = 0; c + 1 < begin.size(); ++c)
    weight.push_back(weight_of_a_cell + static_cast<double>(begin[c + 1] - begin[c]));
  const auto kept = snapshot();
  balance::Options options;
  options.keep_below = 1.03;
  auto moved = balance::rebalance(*comm_, std::move(mesh), weight, options);
  mesh = std::move(moved.mesh);
  const bool any = moved.report.moved_cells > 0;
  if (any) {
    make();
    restore(*comm_, kept, "memory", key_, *run, *flow);
    ++n_moves_;
  }
  rule_.moved(comm_->max(wall_seconds() - start));
  return any;
}

}  // namespace pamr::dsmc
