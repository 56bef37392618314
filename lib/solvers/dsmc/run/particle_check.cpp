// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/particle_check.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <utility>

#include "pamr/base/error.hpp"
#include "solvers/dsmc/run/body_laws.hpp"

namespace pamr::dsmc {

double error_per_difference(double separation) {
  const double nearer = separation * separation, spread = std::cbrt(fewer_particles * fewer_particles);
  // (sqrt(1 + nearer) - 1) / (sqrt(1 + spread nearer) - sqrt(1 + nearer)), without differences.
  const double root = std::sqrt(1 + nearer);
  return (std::sqrt(1 + spread * nearer) + root) / ((spread - 1) * (root + 1));
}

double CheckedCoefficient::difference_error() const { return std::hypot(all.error, fewer.error); }

double CheckedCoefficient::error() const {
  return error_per_difference(separation) * std::max(std::fabs(difference()), 2 * difference_error());
}

void require_checkable(const Case& c) {
  if (c.schedule.window > 0)
    throw Error(
        fmt::format("{}: expected no window in [run] beside --check-resolution, which needs averages of a steady "
                    "flow, found window = {}",
                    c.where, c.schedule.window));
}

ParticleCheck check_particles(const Computation& computation, double separation, const Observer& observer) {
  auto c = computation.the_case();
  require_checkable(c);
  const auto& averaging = computation.averaging();
  const auto all = averaging.results();
  if (all.groups.n_groups < 2)
    throw Error(
        "--check-resolution: expected two blocks of averages at least, found fewer: use more sampling in [run]");
  c.schedule.block = averaging.block_steps();
  c.schedule.sampling = c.schedule.block * static_cast<std::int64_t>(all.n_blocks);
  c.schedule.stop_error = 0;
  auto setup = computation.flow().setup();
  setup.fnum *= fewer_particles;
  Computation second(computation.comm(), c, std::move(setup), computation.mesh());
  second.transfer_from(computation.snapshot());
  second.keep_cells();
  advance(second, {}, observer);
  second.finish();
  const auto fewer = second.averaging().results();
  const double student_all = student_95(all.groups.n_groups), student_fewer = student_95(fewer.groups.n_groups);
  ParticleCheck check{
      {}, second.flow().n_particles(), second.flow().steps_done - second.averaging().state().first_step};
  const auto& flow = computation.flow();
  const auto facets = error_of_facets(computation.comm(), c, flow.setup(), computation.mesh(), flow.domain().boundary);
  const auto add = [&](const char* name, const Estimate& one, const Estimate& other, double off) {
    check.coefficients.push_back({name, one, other, student_all, student_fewer, separation, off});
  };
  add("C_D", all.body.drag, fewer.body.drag, facets.drag);
  if (c.reference.gives_lift()) {
    add("C_L", all.body.lift, fewer.body.lift, facets.lift);
    add("C_m", all.body.moment, fewer.body.moment, facets.moment);
  }
  add("C_H", all.body.heat, fewer.body.heat, facets.heat);
  return check;
}

nlohmann::json to_json(const ParticleCheck& check) {
  nlohmann::json shown{{"particles", check.n_particles}, {"steps", check.n_steps}};
  for (const auto& one : check.coefficients)
    shown[one.name] = {{"value", one.fewer.value},
                       {"ci95", one.student_fewer * one.fewer.error},
                       {"difference", one.difference()},
                       {"difference_stderr", one.difference_error()},
                       {"error", one.error()},
                       {"facets", one.facets},
                       {"bound", one.bound()}};
  return shown;
}

std::vector<std::string> describe(const ParticleCheck& check) {
  std::vector<std::string> lines;
  for (const auto& one : check.coefficients)
    lines.push_back(
        fmt::format("{} {:.4f} +- {:.4f} with a quarter of the particles: {:.4f} of chance, {:.4f} of "
                    "too few particles and {:.4f} of flat facets make {:.4f} +- {:.4f}",
                    one.name, one.fewer.value, one.student_fewer * one.fewer.error, one.student_all * one.all.error,
                    one.error(), one.facets, one.all.value, one.bound()));
  return lines;
}

}  // namespace pamr::dsmc
