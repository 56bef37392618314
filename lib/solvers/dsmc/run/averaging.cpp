// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/averaging.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/mesh/box_of_nodes.hpp"
#include "pamr/par/reproducible_sum.hpp"
#include "solvers/dsmc/flow/gas_contents.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

constexpr std::size_t window = 10;  ///< intervals of a window of the steadiness test
constexpr double max_steps = 1e15;  ///< that are worth counting: no computer does as many

/// Whether gas comes through patches and no stream passes: flows from vessel to vessel, through ducts.
bool is_through_patches(const Setup& setup) {
  const auto has = [&](bool (BoundaryCondition::*kind)() const) {
    return std::any_of(setup.patch.begin(), setup.patch.end(), [&](const auto& patch) { return (patch.*kind)(); });
  };
  return has(&BoundaryCondition::is_driven) ||
         (norm(setup.stream.front().velocity) == 0 && has(&BoundaryCondition::brings_gas));
}

/// Steps in which a flow through patches forgets itself. As many molecules as are inside come in from gas at rest in
/// the time in which their number forgets itself by a factor of e; the speed at an inlet or outlet does so in twice the
/// steps that it is averaged over, because half of what is off comes back (`DrivenPatch`). After four times as many
/// 2 % are left. Collective.
double exchange_steps(const Flow& flow) {
  const auto& setup = flow.setup();
  const auto& domain = flow.domain();
  std::array<par::ExactSum, 2> sums;
  for (const double volume : domain.volume) sums[0].add(volume);
  double relaxation = 0;
  for (const auto& face : domain.boundary)
    if (setup.patch[at(face.patch)].is_open()) sums[1].add(face.area);
  for (const auto& patch : setup.patch)
    if (patch.is_driven()) relaxation = std::max(relaxation, patch.relaxation);
  const auto total = par::reproducible_sums(flow.comm(), sums);
  constexpr double forgotten = 4;
  if (!(total[1] > 0)) return 2 * forgotten * relaxation;
  const double c = most_probable_speed(setup.stream.front().temperature, setup.gas.mean_mass());
  const double time = total[0] / total[1] * 2 * std::sqrt(std::numbers::pi) / c;
  return forgotten * std::max(time / setup.dt * setup.mean_dt_ratio, 2 * relaxation);
}

/// Steps in which the free stream passes the domain, on average over the volume where time steps vary, or in which a
/// flow through patches forgets itself. Collective.
double flow_through_steps(const Flow& flow, const mesh::DistMesh& mesh) {
  const auto& setup = flow.setup();
  const auto extent = setup.unit * mesh::box_of_nodes(flow.comm(), mesh).size();
  const auto& free = setup.stream.front();
  const double c = most_probable_speed(free.temperature, setup.gas.mean_mass());
  double time = 1e300;
  for (std::size_t k = 0; k < 3; ++k) time = std::min(time, extent[k] / std::max(std::fabs(free.velocity[k]), 0.5 * c));
  const double steps = time / setup.dt * setup.mean_dt_ratio;
  return std::clamp(is_through_patches(setup) ? std::max(steps, exchange_steps(flow)) : steps, 1.0, max_steps);
}

}  // namespace

Averaging::Averaging(const Case& the_case, const mesh::DistMesh& mesh, const Flow& flow)
    : schedule_(the_case.schedule),
      point_(the_case.reference.point),
      scale_(the_case.gas, the_case.stream.front(), the_case.reference),
      body_(reference_patches(the_case.reference, flow.setup().patches_on(mesh), flow.setup().patch)) {
  const auto& patches = flow.setup().patches_on(mesh);
  const bool is_by_flux = is_through_patches(flow.setup());
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (flow.setup().patch[p].is_wall()) walls_.emplace_back(p, patches[p].name);
    if (is_by_flux && flow.setup().patch[p].is_open()) openings_.emplace_back(p, patches[p].name);
  }
  interval_ = std::max<std::int64_t>(1, std::llround(flow_through_steps(flow, mesh) / window));
  state_.block_steps = schedule_.block > 0 ? schedule_.block : std::max<std::int64_t>(1, schedule_.sampling / 20);
  state_.face.resize(flow.domain().boundary.size());
}

void Averaging::resume(RunState state) {
  if (!state.sampling)
    state.block_steps = state_.block_steps;
  else if (schedule_.block > 0 && schedule_.block != state.block_steps)
    throw Error(
        fmt::format("expected blocks of {0} steps, which the averages so far have, found {1} in the case: "
                    "give block = {0} in [run], or begin new averages with --carry",
                    state.block_steps, schedule_.block));
  state_ = std::move(state);
}

void Averaging::begin_transferred(std::uint64_t step) {
  state_.first_step = step;
  state_.transferred = true;
}

std::int64_t Averaging::passage_steps() const { return interval_ * std::int64_t{window}; }

std::uint64_t Averaging::discarded() const {
  return state_.transferred ? static_cast<std::uint64_t>(passage_steps()) : 0;
}

std::uint64_t Averaging::first_sampled_step() const {
  return state_.first_step + std::max(discarded(), static_cast<std::uint64_t>(schedule_.transient.value_or(0)));
}

std::uint64_t Averaging::expected_steps() const {
  const auto sampled = static_cast<std::uint64_t>(schedule_.sampling);
  if (state_.sampling) return state_.sampling_since + sampled;
  return sampled +
         static_cast<std::uint64_t>(schedule_.transient ? *schedule_.transient : 2 * interval_ * std::int64_t{window});
}

void Averaging::before_step(Flow& flow) {
  if (state_.contents.n.empty() && state_.in_interval == 0) state_.contents = contents_of(flow);
  if (!state_.sampling && schedule_.transient && flow.steps_done >= first_sampled_step())
    begin_sampling(flow, Begun::by_case, fmt::format("averages begin after step {} as the case says", flow.steps_done));
}

void Averaging::after_step(Flow& flow, const StepTotals& counts) {
  auto& row = state_.interval;
  row.entered += counts.entered;
  row.left += counts.left;
  row.wall_hits += counts.wall_hits;
  row.collisions += counts.collisions;
  row.crossings += counts.crossings;
  state_.stuck += counts.stuck;
  state_.clamped += counts.clamped;
  ++state_.in_interval;
  if (state_.in_interval >= (state_.sampling ? state_.block_steps : interval_)) end_interval(flow);
}

bool Averaging::is_complete(std::uint64_t steps_done) const {
  if (!state_.sampling) return false;
  const auto sampled = static_cast<std::int64_t>(steps_done - state_.sampling_since);
  if (sampled >= schedule_.sampling) return true;
  if (schedule_.stop_error == 0 || state_.blocks.size() < 20 || state_.in_interval != 0) return false;
  const auto drag = results().body.drag;
  return drag.value != 0 && drag.error <= schedule_.stop_error * std::fabs(drag.value);
}

void Averaging::begin_sampling(Flow& flow, Begun begun, const std::string& reason) {
  if (state_.in_interval > 0) end_interval(flow);
  state_.sampling = true;
  state_.sampling_since = flow.steps_done;
  state_.begun = begun;
  state_.steady_reason = reason;
  flow.start_sampling();
}

void Averaging::end_interval(Flow& flow) {
  const auto faces = flow.end_block();
  const auto& setup = flow.setup();
  const auto loads =
      patch_loads(flow.comm(), flow.domain(), {flow.surface, faces, setup.fnum / setup.dt, state_.in_interval}, point_,
                  setup.patch.size());
  auto row = std::exchange(state_.interval, {});
  row.step = flow.steps_done;
  row.sampled = state_.sampling;
  row.n_steps = std::exchange(state_.in_interval, 0);
  row.particles = flow.n_particles();
  row.body = scale_.coefficients(sum_of(loads, body_));
  auto contents = contents_of(flow);
  const auto temperatures = temperatures_of(contents, flow);
  row.t_tr = temperatures.translational;
  row.t_rot = temperatures.rotational;
  row.t_vib = temperatures.vibrational;
  end_fluxes(flow, std::move(contents), row);
  state_.history.push_back(row);
  if (state_.sampling) {
    state_.blocks.push_back(loads);
    for (std::size_t f = 0; f < faces.size(); ++f) state_.face[f].add_block(faces[f], flow.domain().boundary[f].normal);
    const bool is_full = std::any_of(state_.face.begin(), state_.face.end(),
                                     [](const auto& face) { return face.sums.is_nearly_full(); });
    if (flow.comm().any(is_full))
      throw Error(fmt::format(
          "step {}: expected fewer molecules on each face of a wall in all averages, found more than can be "
          "added up: average over fewer steps",
          flow.steps_done));
    begin_anew_if_not_steady(flow);
  } else if (!schedule_.transient && row.n_steps == interval_) {
    assess_steadiness_of(flow);
  }
}

/// Compares what has passed the patches in the interval with the contents before and after it, and ends it. What an
/// older version has begun is not complete, and does not count. Collective.
void Averaging::end_fluxes(Flow& flow, GasContents contents, HistoryRow& row) {
  const auto& setup = flow.setup();
  const auto words = total_fluxes(flow.comm(), flow.flux);
  flow.flux.clear();
  const auto before = std::exchange(state_.contents, std::move(contents));
  if (before.n.empty()) return;
  state_.balance.add(before, state_.contents, words, setup.patch.size(), row.collisions);
  auto rates = flux_rates(words, setup.gas,
                          {flow.surface.momentum_unit, flow.surface.energy_unit, setup.fnum / setup.dt, row.n_steps});
  row.fluxes = net_fluxes(rates, setup.gas.species.size());
  row.species = molecules_of_species(rates, setup.gas.species.size());
  if (state_.sampling) state_.flux_blocks.push_back(std::move(rates));
}

/// Begins sampling if the history says that the flow is steady, or if the transient has lasted for too long.
void Averaging::assess_steadiness_of(Flow& flow) {
  std::vector<Series> series{{"the number of particles", {}}};
  if (openings_.empty()) series.insert(series.end(), {{"the drag", {}}, {"the heat to the walls", {}}});
  for (const auto& [p, name] : openings_) series.push_back({fmt::format("the molecules through {}", name), {}});
  for (const auto& old : state_.history) {
    if (old.sampled || old.step <= state_.first_step + discarded()) continue;
    if (!openings_.empty() && old.fluxes.empty()) continue;
    series[0].value.push_back(static_cast<double>(old.particles));
    if (openings_.empty()) {
      series[1].value.push_back(old.body.drag);
      series[2].value.push_back(old.body.heat);
    }
    for (std::size_t k = 0; k < openings_.size(); ++k) {
      const auto& flux = old.fluxes[openings_[k].first];
      series[1 + k].value.push_back(flux[0] + flux[1]);
    }
  }
  // Where the noise of few particles hides the slope, windows two, four, ... times as long are tried too.
  auto verdict = assess_steadiness(series, window);
  for (std::size_t longer = 2 * window; !verdict.is_steady && 2 * longer <= series[0].value.size(); longer *= 2)
    if (auto other = assess_steadiness(series, longer); other.is_steady) verdict = std::move(other);
  if (verdict.is_steady)
    begin_sampling(flow, Begun::steady, fmt::format("steady after step {}: {}", flow.steps_done, verdict.reason));
  else if (flow.steps_done >= state_.first_step + static_cast<std::uint64_t>(schedule_.max_transient))
    begin_sampling(flow, Begun::most_transient,
                   fmt::format("not steady after step {} (most_transient), averages begin all the same: {}",
                               flow.steps_done, verdict.reason));
}

/// Throws away averages that drift, if nobody has asked for them as they are and there is time for others.
void Averaging::begin_anew_if_not_steady(Flow& flow) {
  const bool may = !schedule_.transient && schedule_.window == 0 &&
                   flow.steps_done < state_.first_step + static_cast<std::uint64_t>(schedule_.max_transient);
  if (!may) return;
  const auto n_blocks = state_.blocks.size();
  const auto found = drifts_of(trends());
  if (found.empty()) return;
  for (auto& row : state_.history) row.sampled = false;
  state_.sampling_since = flow.steps_done;
  ++state_.n_restarts;
  state_.steady_reason = fmt::format("averages begun anew after step {}: in the {} blocks of {} steps before {}",
                                     flow.steps_done, n_blocks, state_.block_steps, found);
  begin_window(flow);
}

bool Averaging::is_window_full(std::uint64_t steps_done) const {
  if (schedule_.window == 0 || !state_.sampling || steps_done == state_.sampling_since) return false;
  return (steps_done - state_.sampling_since) % static_cast<std::uint64_t>(schedule_.window) == 0;
}

void Averaging::begin_window(Flow& flow) {
  state_.blocks.clear();
  state_.flux_blocks.clear();
  state_.face.assign(flow.domain().boundary.size(), {});
  flow.start_sampling();
}

void Averaging::finish(Flow& flow) {
  if (state_.in_interval == 0) return;
  if (state_.sampling && state_.blocks.empty()) return end_interval(flow);
  if (state_.contents.n.empty()) return;
  const auto words = total_fluxes(flow.comm(), flow.flux);
  state_.balance.add(state_.contents, contents_of(flow), words, flow.setup().patch.size(), state_.interval.collisions);
}

Averaging::CoefficientSeries Averaging::series_of(const LoadOf& part) const {
  CoefficientSeries series;
  for (const auto& block : state_.blocks) {
    const auto c = scale_.coefficients(part(block));
    series.drag.push_back(c.drag);
    series.lift.push_back(c.lift);
    series.moment.push_back(c.moment);
    series.heat.push_back(c.heat);
  }
  return series;
}

Grouping Averaging::groups() const { return group_blocks(state_.blocks.size(), state_.block_steps, passage_steps()); }

std::vector<Results::Trend> Averaging::trends() const {
  const auto n = groups().n_groups;
  if (n < 10 || schedule_.window > 0) return {};
  const auto body = series_of([&](const std::vector<Load>& loads) { return sum_of(loads, body_); });
  std::vector<Results::Trend> trends{{"C_D", "the drag", fit_line(group_means(body.drag, n))},
                                     {"C_H", "the heat to the walls", fit_line(group_means(body.heat, n))}};
  for (const auto& [p, name] : openings_) {
    std::vector<double> net;
    for (const auto& row : state_.history)
      if (row.sampled && !row.fluxes.empty()) net.push_back(row.fluxes[p][0] - row.fluxes[p][1]);
    if (net.size() >= n)
      trends.push_back({name, fmt::format("the net flux through {}", name), fit_line(group_means(net, n))});
  }
  return trends;
}

Results Averaging::results() const {
  Results results;
  results.n_blocks = state_.blocks.size();
  results.groups = groups();
  results.trends = trends();
  const auto of = [&](const std::string& name, const LoadOf& part) {
    const auto n = results.groups.n_groups;
    const auto s = series_of(part);
    return Results::OfPatch{name, estimate(s.drag, n), estimate(s.lift, n), estimate(s.moment, n), estimate(s.heat, n)};
  };
  results.body = of("", [&](const std::vector<Load>& loads) { return sum_of(loads, body_); });
  for (const auto& [p, name] : walls_)
    results.walls.push_back(of(name, [p = p](const auto& loads) { return loads[p]; }));
  return results;
}

SurfaceFlux Averaging::flux(std::size_t surface, int species, std::size_t n_species) const {
  return mean_flux(state_.flux_blocks, flux_groups().n_groups, surface, species, n_species);
}

Grouping Averaging::flux_groups() const {
  return group_blocks(state_.flux_blocks.size(), state_.block_steps, passage_steps());
}

std::string drifts_of(const std::vector<Results::Trend>& trends) {
  std::string text;
  for (const auto& [coefficient, name, line] : trends)
    if (drifts(line))
      text += fmt::format("{}{} changed by {:+.2f} +- {:.2f} %", text.empty() ? "" : ", ", name,
                          100 * line.change / std::fabs(line.mean), 100 * line.change_bound() / std::fabs(line.mean));
  return text;
}

bool is_finite(const Results& results) {
  const auto is_sound = [](const Results::OfPatch& part) {
    for (const auto& e : {part.drag, part.lift, part.moment, part.heat})
      if (!std::isfinite(e.value) || !std::isfinite(e.error)) return false;
    return true;
  };
  return is_sound(results.body) && std::all_of(results.walls.begin(), results.walls.end(), is_sound);
}

}  // namespace pamr::dsmc
