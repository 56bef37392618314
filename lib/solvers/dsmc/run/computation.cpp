// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/computation.hpp"

#include <algorithm>
#include <utility>
#include <vector>

#include "pamr/balance/rebalance.hpp"
#include "pamr/base/timer.hpp"
#include "pamr/base/with_file_name.hpp"
#include "pamr/mesh/require_field.hpp"
#include "solvers/dsmc/run/adapt_mesh.hpp"
#include "solvers/dsmc/run/make_setup.hpp"
#include "solvers/dsmc/run/same_case.hpp"
#include "solvers/dsmc/sampling/cell_flow.hpp"
#include "solvers/dsmc/sampling/density_scale.hpp"
#include "solvers/dsmc/state/header_values.hpp"
#include "solvers/dsmc/state/require_sound.hpp"
#include "solvers/dsmc/state/section_file.hpp"

namespace pamr::dsmc {

namespace {

constexpr int steps_between_checks = 20;  ///< of the balance

/// The tables of a flow; the snapshot loses them.
OldFlow old_flow(Snapshot& snapshot, const Flow& flow, const std::string& name) {
  OldFlow old;
  old.name = name;
  old.cells = std::move(snapshot.cells);
  old.particles = std::move(snapshot.particles);
  for (const auto& species : flow.setup().gas.species) {
    old.weights.push_back(species.weight);
    old.vibration.push_back(species.vibration);
  }
  old.is_weighted = flow.setup().gas.is_weighted;
  old.is_vibrating = flow.setup().gas.is_vibrating;
  old.steps_done = snapshot.header["steps_done"];
  return old;
}

/// What a cell with `n` particles costs in a step, in particles that only fly, from measurements: an empty cell half a
/// particle, a candidate pair somewhat less than one and more where many are compared for the nearest partner.
double cost_of(double n_candidates, std::uint32_t n) {
  constexpr std::uint32_t max_compared = 512;
  return 0.5 + n + n_candidates * (0.7 + 0.008 * std::min(n, max_compared));
}

}  // namespace

Computation::Computation(const par::Comm& comm, Case the_case, Setup setup, mesh::DistMesh given)
    : comm_(&comm),
      case_(std::move(the_case)),
      mesh_(std::move(given)),
      key_(key_of(comm, mesh_)),
      begun_on_(key_.fingerprint) {
  flow_.emplace(comm, mesh_, std::move(setup));
  facts_ = facts_of(comm, case_, flow_->setup(), mesh_);
  averaging_.emplace(case_, mesh_, *flow_);
  if (case_.adaptation.every > 0) require_criteria(comm, mesh_, case_.adaptation, averages_as_fields(), case_.where);
}

void Computation::restart(const std::string& checkpoint) {
  const SectionFile file(*comm_, checkpoint);
  with_file_name(checkpoint, [&] {
    require_same_mesh(file, key_);
    require_same_case(file.header(), facts_);
  });
  begun_on_ = with_file_name(checkpoint, [&] { return begun_on(file.header()); });
  const auto snapshot = read_checkpoint(file, case_.gas);
  require_sound(*comm_, checkpoint, snapshot, sound_range(*flow_));
  with_file_name(checkpoint, [&] { averaging_->resume(restore(*comm_, snapshot, *flow_)); });
  require_places(*comm_, checkpoint, *flow_);
  if (snapshot.header.contains("mesh_step"))
    restarted_mesh_ = mesh_step_ = static_cast<std::uint64_t>(with_file_name(checkpoint, [&] {
      return count_of(snapshot.header["mesh_step"], "mesh_step", static_cast<std::int64_t>(flow_->steps_done));
    }));
}

Snapshot Computation::snapshot() const {
  auto snapshot = take_snapshot(*comm_, key_, averaging_->state(), *flow_);
  snapshot.header[facts_member] = facts_;
  if (case_.adaptation.every > 0 && begun_on_) snapshot.header[begun_on_member] = *begun_on_;
  return snapshot;
}

Transferred Computation::transfer_from(const std::string& checkpoint) {
  const auto transferred = transfer_particles(*comm_, checkpoint, mesh_, *flow_);
  averaging_->begin_transferred(transferred.step);
  return transferred;
}

Transferred Computation::transfer_from(Snapshot snapshot) {
  const bool is_same = is_of_mesh(snapshot.header, key_);
  const auto old = old_flow(snapshot, *flow_, case_.where);
  const auto transferred =
      is_same ? transfer_particles(*comm_, old, mesh_, *flow_) : transfer_particles(*comm_, old, {}, mesh_, *flow_);
  averaging_->begin_transferred(transferred.step);
  return transferred;
}

StepResult Computation::step(bool wants_stop) {
  if (averaging_->is_window_full(flow_->steps_done)) {
    const auto every = static_cast<std::uint64_t>(case_.adaptation.every);
    if (every > 0 && (flow_->steps_done - averaging_->state().sampling_since) % every == 0) adapt();
    averaging_->begin_window(*flow_);
  }
  averaging_->before_step(*flow_);
  const auto counts = flow_->step(wants_stop);
  averaging_->after_step(*flow_, counts.all);
  const StepResult result{is_complete(), counts.all.stop, averaging_->is_window_full(flow_->steps_done)};
  computed_ += counts.compute_seconds;
  traffic_ += counts.traffic;
  if (!is_dynamic_ || comm_->size() == 1 || ++steps_ < steps_between_checks) return result;
  double longest = 0, mean = 0;
  for (const double one : comm_->all_gather(computed_ - std::exchange(checked_, computed_))) {
    longest = std::max(longest, one);
    mean += one / comm_->size();
  }
  steps_ = 0;
  if (rule_.add(longest, mean) && !result.is_complete) rebalance();
  return result;
}

std::vector<mesh::CellField> Computation::averages_as_fields() const {
  const auto& setup = flow_->setup();
  auto cells = average_cells(flow_->domain(), setup.gas, flow_->cells, flow_->collisions, setup.unit);
  cells.scale = density_scale(*comm_, mesh_, cells.density);
  return to_fields(std::move(cells), setup.gas);
}

void Computation::adapt() {
  const double start = cpu_seconds();
  const auto& setup_now = flow_->setup();
  auto averages = averages_as_fields();
  auto snapshot = this->snapshot();
  const auto old = old_flow(snapshot, *flow_, case_.where + ": [adapt]");
  const auto n_before = mesh_.info.n_global_cells;
  auto adapted = adapt_mesh(*comm_, std::move(mesh_), case_.adaptation, std::move(averages), case_.where);
  mesh_step_ = flow_->steps_done;
  mesh_ = std::move(adapted.mesh);
  key_ = key_of(*comm_, mesh_);
  auto setup = setup_now;
  setup.cell_dt = make_cell_dt(case_, mesh_, setup.unit);
  const auto driven = flow_->driven_means();
  flow_.emplace(*comm_, mesh_, std::move(setup));
  flow_->set_driven_means(driven);
  facts_ = facts_of(*comm_, case_, flow_->setup(), mesh_);
  const auto transferred = transfer_particles(*comm_, old, adapted.gone, mesh_, *flow_);
  mesh::remove_field(mesh_.cell_fields, mesh::parent_field);  // it names cells of a mesh that nobody has any more
  flow_->resume(true);
  averaging_->begin_window(*flow_);
  averaging_->forget_contents();
  auto& report = adaptation_;
  const auto n_cells = mesh_.info.n_global_cells;
  report.min_cells = std::min({report.n_times == 0 ? n_before : report.min_cells, n_before, n_cells});
  report.max_cells = std::max({report.max_cells, n_before, n_cells});
  report.cells_marked += adapted.cells_marked;
  report.octets_gone += adapted.octets_gone;
  report.removed += transferred.removed;
  ++report.n_times;
  if (is_dynamic_) rebalance();
  report.seconds += cpu_seconds() - start;
}

bool Computation::rebalance() {
  if (comm_->size() == 1) return false;
  const double start = cpu_seconds();
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
  // Like what is lost to imbalance in processor seconds: by the clock a move takes longer where ranks share a core.
  const double cost = comm_->max(cpu_seconds() - start);
  move_seconds_ += cost;
  rule_.moved(cost);
  return any;
}

}  // namespace pamr::dsmc
