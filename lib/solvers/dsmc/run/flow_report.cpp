// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/flow_report.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

namespace pamr::dsmc {

namespace {

using nlohmann::json;

json shown(const Estimate& e) { return {{"value", e.value}, {"stderr", e.error}}; }

json shown(const Results::OfPatch& p) {
  return {{"C_D", shown(p.drag)}, {"C_L", shown(p.lift)}, {"C_m", shown(p.moment)}, {"C_H", shown(p.heat)}};
}

json shown(const Reference& r, const Scale& scale) {
  return {{"area", r.area},
          {"length", r.length},
          {"point", {r.point.x, r.point.y, r.point.z}},
          {"multiplier", r.multiplier},
          {"patches", r.patches},
          {"dynamic_pressure", scale.dynamic_pressure()},
          {"speed", scale.speed()}};
}

json shown(const Species& s) {
  return {{"name", s.name},
          {"mass", s.mass},
          {"diameter", s.diameter},
          {"omega", s.omega},
          {"t_ref", s.t_ref},
          {"alpha", s.alpha},
          {"rotational_degrees", s.rotational_degrees}};
}

}  // namespace

json report_of(const Computation& computation, const Outcome& outcome) {
  const auto& c = computation.the_case();
  const auto& flow = computation.flow();
  const auto& averaging = computation.averaging();
  const auto& state = averaging.state();
  const auto results = averaging.results();
  json report{{"particles", outcome.n_particles},
              {"steps", flow.steps_done},
              {"particle_steps_per_second_per_core", outcome.advance.rate()},
              {"lost_particles", flow.lost()},
              {"lambda_inf", outcome.plan.mean_free_path},
              {"blocks", results.n_blocks},
              {"began_at_step", state.first_step},
              {"averages_from_step", state.sampling_since},
              {"steady", state.steady_reason},
              {"abandoned_particles", state.stuck},
              {"clamped_relaxations", state.clamped},
              {"rebalanced", computation.n_moves()}};
  if (const auto& a = computation.adaptation(); c.adaptation.every > 0)
    report["adaptation"] = {{"times", a.n_times},           {"cells_marked", a.cells_marked},
                            {"octets_gone", a.octets_gone}, {"min_cells", a.min_cells},
                            {"max_cells", a.max_cells},     {"removed_particles", a.removed},
                            {"seconds", a.seconds},         {"cells", computation.mesh().info.n_global_cells}};
  const auto& ranks = outcome.advance.ranks;
  report["decomposition"] = {{"ranks", computation.comm().size()},    {"dynamic", computation.is_dynamic()},
                             {"moves", computation.n_moves()},        {"imbalance", ranks.imbalance},
                             {"messages_per_step", ranks.messages},   {"bytes_per_step", ranks.bytes},
                             {"exchanges_per_step", ranks.exchanges}, {"reductions_per_step", ranks.reductions}};
  report.update(shown(results.body));
  report["reference"] = shown(c.reference, averaging.scale());
  for (const auto& species : c.gas.species) report["species"].push_back(shown(species));
  for (const auto& wall : results.walls) report["patches"][wall.patch] = shown(wall);
  report["plan"] = to_json(outcome.plan);
  report["quality"] = to_json(outcome.resolution);
  return report;
}

std::string summary_of(const Computation& computation, const Outcome& outcome) {
  const auto results = computation.averaging().results();
  const auto line = fmt::format("{} steps, {} particles, none lost, {:.3g} particle-steps per CPU second",
                                computation.flow().steps_done, outcome.n_particles, outcome.advance.rate());
  if (results.n_blocks == 0 || results.walls.empty()) return line;
  const auto& body = results.body;
  return fmt::format("{}; C_D {:.4f} +- {:.4f}, C_L {:.4f} +- {:.4f}, C_m {:.4f} +- {:.4f}, C_H {:.4f} +- {:.4f}", line,
                     body.drag.value, body.drag.error, body.lift.value, body.lift.error, body.moment.value,
                     body.moment.error, body.heat.value, body.heat.error);
}

std::string summary_of(const Transferred& transferred) {
  return fmt::format("carried {} particles from step {}: {} now inside walls removed, {} particles with the new weight",
                     transferred.old_particles, transferred.step, transferred.removed, transferred.new_particles);
}

}  // namespace pamr::dsmc
