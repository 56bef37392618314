// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/run.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "solvers/dsmc/gas/kinetic_theory.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

constexpr std::size_t window = 10;  ///< intervals of a window of the steadiness test

/// Steps in which the free stream passes the domain, on average over the volume where time steps vary.
double flow_through_steps(const Flow& flow, const mesh::DistMesh& mesh) {
  const auto& comm = flow.comm();
  const auto& setup = flow.setup();
  double low[3], high[3];
  for (std::size_t k = 0; k < 3; ++k) {
    low[k] = 1e300;
    high[k] = -1e300;
  }
  for (const auto& p : mesh.node_position) {
    const double x[3] = {p.x, p.y, p.z};
    for (std::size_t k = 0; k < 3; ++k) {
      low[k] = std::min(low[k], x[k]);
      high[k] = std::max(high[k], x[k]);
    }
  }
  double extent[3];
  for (std::size_t k = 0; k < 3; ++k) extent[k] = setup.unit * (comm.max(high[k]) - comm.min(low[k]));
  const auto& free = setup.stream.front();
  const double c = most_probable_speed(free.temperature, setup.gas.mean_mass());
  const double v[3] = {free.velocity.x, free.velocity.y, free.velocity.z};
  double time = 1e300;
  for (std::size_t k = 0; k < 3; ++k) time = std::min(time, extent[k] / std::max(std::fabs(v[k]), 0.5 * c));
  return std::max(1.0, time / setup.dt * setup.slowness);
}

/// Temperatures of all particles together. Sums in fixed point, so that they do not depend on the ranks. Collective.
struct Temperatures {
  double translational = 0, rotational = 0;
};
Temperatures temperatures_of(const Flow& flow) {
  const auto& p = flow.particles;
  const auto& species = flow.setup().gas.species;
  const auto& units = flow.surface;
  std::vector<std::int64_t> sums(5 + species.size(), 0);  // momentum, energies, numbers of the species
  const auto fixed = [](double value) { return std::llrint(value); };
  for (std::size_t i = 0; i < p.size(); ++i) {
    const double w = species[p.species[i]].weight, m = w * species[p.species[i]].mass;
    const Vec3 v = p.velocity(i);
    sums[0] += fixed(m * v.x / units.momentum_unit);
    sums[1] += fixed(m * v.y / units.momentum_unit);
    sums[2] += fixed(m * v.z / units.momentum_unit);
    sums[3] += fixed(0.5 * m * squared_norm(v) / units.energy_unit);
    sums[4] += fixed(w * p.rotation[i] / units.energy_unit);
    ++sums[5 + p.species[i]];
  }
  flow.comm().sum_in_place(sums);
  double mass = 0, n = 0, molecules = 0, degrees = 0;
  for (std::size_t s = 0; s < species.size(); ++s) {
    n += static_cast<double>(sums[5 + s]);
    const double count = species[s].weight * static_cast<double>(sums[5 + s]);
    mass += species[s].mass * count;
    molecules += count;
    degrees += species[s].rotational_degrees * count;
  }
  if (n < 2) return {};
  const Vec3 momentum = units.momentum_unit *
                        Vec3{static_cast<double>(sums[0]), static_cast<double>(sums[1]), static_cast<double>(sums[2])};
  const double energy = units.energy_unit * static_cast<double>(sums[3]) - squared_norm(momentum) / (2 * mass);
  return {energy / (1.5 * boltzmann * (molecules - molecules / n)),
          degrees > 0 ? units.energy_unit * static_cast<double>(sums[4]) / (0.5 * degrees * boltzmann) : 0};
}

}  // namespace

Run::Run(const Case& the_case, const mesh::DistMesh& mesh, Flow& flow)
    : case_(&the_case),
      mesh_(&mesh),
      flow_(&flow),
      scale_(the_case.gas, the_case.stream.front(), the_case.reference),
      body_(reference_patches(the_case.reference, mesh.info.patches, flow.setup().patch)) {
  interval_ = std::max<std::int64_t>(1, std::llround(flow_through_steps(flow, mesh) / window));
  block_ = the_case.block > 0 ? the_case.block : std::max<std::int64_t>(1, the_case.sampling / 20);
  state.face.resize(flow.domain().boundary.size());
}

std::uint64_t Run::discarded() const { return state.carried ? static_cast<std::uint64_t>(interval_) * window : 0; }

std::uint64_t Run::first_sampled_step() const {
  return state.first_step + std::max(discarded(), static_cast<std::uint64_t>(case_->transient.value_or(0)));
}

std::uint64_t Run::expected_steps() const {
  const auto sampled = static_cast<std::uint64_t>(case_->sampling);
  if (state.sampling) return state.sampling_since + sampled;
  return sampled +
         static_cast<std::uint64_t>(case_->transient ? *case_->transient : 2 * interval_ * std::int64_t{window});
}

bool Run::step() {
  if (!state.sampling && case_->transient && flow_->steps_done >= first_sampled_step())
    begin_sampling(fmt::format("averages begin after step {} as the case says", flow_->steps_done));
  last_step_ = flow_->step();
  const auto& counts = last_step_;
  std::int64_t sums[] = {
      counts.entered,         counts.moved.left,      counts.moved.wall_hits, counts.collided.collisions,
      counts.moved.crossings, counts.moved.abandoned, counts.collided.clamped};
  flow_->comm().sum_in_place(sums);
  auto& row = state.interval;
  row.entered += sums[0];
  row.left += sums[1];
  row.wall_hits += sums[2];
  row.collisions += sums[3];
  row.crossings += sums[4];
  state.abandoned += sums[5];
  state.clamped += sums[6];
  ++state.in_interval;
  if (state.in_interval == (state.sampling ? block_ : interval_)) end_interval();
  return is_complete();
}

bool Run::is_complete() const {
  if (!state.sampling) return false;
  const auto sampled = static_cast<std::int64_t>(flow_->steps_done - state.sampling_since);
  if (sampled >= case_->sampling) return true;
  if (case_->stop_error == 0 || state.blocks.size() < 20 || state.in_interval != 0) return false;
  const auto drag = results().drag;
  return drag.value != 0 && drag.error <= case_->stop_error * std::fabs(drag.value);
}

void Run::begin_sampling(const std::string& reason) {
  if (state.in_interval > 0) end_interval();
  state.sampling = true;
  state.sampling_since = flow_->steps_done;
  state.steady_reason = reason;
  flow_->start_sampling();
}

void Run::end_interval() {
  const auto faces = flow_->end_block();
  const auto& setup = flow_->setup();
  const auto& units = flow_->surface;
  const auto loads = patch_loads(flow_->comm(), flow_->domain(), units, faces, setup.molecules / setup.dt,
                                 state.in_interval, case_->reference.point, setup.patch.size());
  auto row = std::exchange(state.interval, {});
  row.step = flow_->steps_done;
  row.sampled = state.sampling;
  row.n_steps = std::exchange(state.in_interval, 0);
  row.particles = flow_->n_particles();
  row.body = scale_.coefficients(sum_of(loads, body_));
  const auto temperatures = temperatures_of(*flow_);
  row.t_tr = temperatures.translational;
  row.t_rot = temperatures.rotational;
  state.history.push_back(row);
  if (state.sampling) {
    state.blocks.push_back(loads);
    for (std::size_t f = 0; f < faces.size(); ++f) {
      const auto& n = flow_->domain().boundary[f].normal;
      const auto& m = faces[f].momentum;
      const double push =
          n.x * static_cast<double>(m[0]) + n.y * static_cast<double>(m[1]) + n.z * static_cast<double>(m[2]);
      const double heat = static_cast<double>(faces[f].energy);
      state.face[f].sums.add(faces[f]);
      state.face[f].heat_squares += heat * heat;
      state.face[f].pressure_squares += push * push;
    }
    return;
  }
  if (case_->transient || row.n_steps != interval_) return;
  std::vector<Series> series{{"the number of particles", {}}, {"the drag", {}}, {"the heat to the walls", {}}};
  for (const auto& old : state.history) {
    if (old.sampled || old.step <= state.first_step + discarded()) continue;
    series[0].value.push_back(static_cast<double>(old.particles));
    series[1].value.push_back(old.body.drag);
    series[2].value.push_back(old.body.heat);
  }
  // Where the noise of so few particles hides the slope, windows twice, four times, ... as long are looked at too.
  auto verdict = judge_steadiness(series, window);
  for (std::size_t longer = 2 * window; !verdict.is_steady && 2 * longer <= series[0].value.size(); longer *= 2)
    if (auto other = judge_steadiness(series, longer); other.is_steady) verdict = std::move(other);
  if (verdict.is_steady)
    begin_sampling(fmt::format("steady after step {}: {}", flow_->steps_done, verdict.reason));
  else if (flow_->steps_done >= state.first_step + static_cast<std::uint64_t>(case_->most_transient))
    begin_sampling(fmt::format("not steady after step {} (most_transient), averages begin all the same: {}",
                               flow_->steps_done, verdict.reason));
}

void Run::finish() {
  if (state.sampling && state.blocks.empty() && state.in_interval > 0) end_interval();
}

Results::OfPatch Run::of(const std::string& name, const std::function<Load(const std::vector<Load>&)>& part) const {
  std::vector<double> drag, lift, moment, heat;
  for (const auto& block : state.blocks) {
    const auto c = scale_.coefficients(part(block));
    drag.push_back(c.drag);
    lift.push_back(c.lift);
    moment.push_back(c.moment);
    heat.push_back(c.heat);
  }
  return {name, estimate(drag), estimate(lift), estimate(moment), estimate(heat)};
}

Results Run::results() const {
  Results results;
  const auto body = of("", [&](const std::vector<Load>& loads) { return sum_of(loads, body_); });
  results.drag = body.drag;
  results.lift = body.lift;
  results.moment = body.moment;
  results.heat = body.heat;
  results.n_blocks = state.blocks.size();
  for (std::size_t p = 0; p < mesh_->info.patches.size(); ++p)
    if (flow_->setup().patch[p].is_wall())
      results.patches.push_back(of(mesh_->info.patches[p].name, [&](const auto& loads) { return loads[p]; }));
  return results;
}

std::string Run::history_csv() const {
  std::string text =
      "step,time,averaged,particles,entered_per_step,left_per_step,wall_hits_per_step,collisions_per_particle_step,"
      "crossings_per_particle_step,C_D,C_L,C_m,C_H,T_tr,T_rot\n";
  for (const auto& row : state.history) {
    const double n = static_cast<double>(row.n_steps),
                 all = n * static_cast<double>(std::max<std::int64_t>(1, row.particles));
    text += fmt::format(
        "{},{:.9g},{},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}\n", row.step,
        static_cast<double>(row.step) * case_->dt, row.sampled ? 1 : 0, row.particles,
        static_cast<double>(row.entered) / n, static_cast<double>(row.left) / n, static_cast<double>(row.wall_hits) / n,
        static_cast<double>(row.collisions) / all, static_cast<double>(row.crossings) / all, row.body.drag,
        row.body.lift, row.body.moment, row.body.heat, row.t_tr, row.t_rot);
  }
  return text;
}

}  // namespace pamr::dsmc
