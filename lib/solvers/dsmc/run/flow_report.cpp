// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/flow_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

#include "solvers/dsmc/run/flux_report.hpp"
#include "solvers/dsmc/run/same_case.hpp"

namespace pamr::dsmc {

namespace {

using nlohmann::json;

/// How reports show the coefficients.
struct Style {
  KnownAverages known;
  bool with_lift = true;
  const Scale& scale;
};

/// What there is not is null.
json shown(const Estimate& e, const Style& style) {
  json j{{"value", nullptr}, {"stderr", nullptr}};
  if (style.known.is_any) j["value"] = e.value;
  if (!std::isfinite(style.known.student)) return j;
  j["stderr"] = e.error;
  j["ci95"] = style.known.student * e.error;
  return j;
}

json shown(const Results::OfPatch& p, const Style& style) {
  const double force = style.scale.force();
  const double power = force * style.scale.speed();
  json j{{"C_D", shown(p.drag, style)},
         {"C_H", shown(p.heat, style)},
         {"drag", shown(Estimate{force * p.drag.value, force * p.drag.error}, style)},
         {"heat", shown(Estimate{power * p.heat.value, power * p.heat.error}, style)}};
  if (style.with_lift) {
    j["C_L"] = shown(p.lift, style);
    j["C_m"] = shown(p.moment, style);
  }
  return j;
}

json averages_of(const Averaging& averaging, const Results& results, double student) {
  json j{{"passage_steps", averaging.passage_steps()}, {"blocks", results.n_blocks},
         {"block_steps", averaging.block_steps()},     {"groups", results.groups.n_groups},
         {"group_steps", results.groups.steps},        {"independent", results.groups.are_independent}};
  if (std::isfinite(student)) j["student_95"] = student;
  for (const auto& [coefficient, name, line] : results.trends)
    j["change"][coefficient] = {
        {"value", line.change}, {"stderr", line.change_error}, {"ci95", line.change_bound()}, {"drifts", drifts(line)}};
  j["begun"] = word_for(averaging.state().begun);
  j["restarts"] = averaging.state().n_restarts;
  return j;
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
  json species{{"name", s.name},
               {"mass", s.mass},
               {"diameter", s.diameter},
               {"omega", s.omega},
               {"t_ref", s.t_ref},
               {"alpha", s.alpha},
               {"rotational_degrees", s.rotational_degrees}};
  if (!s.vibration.mode.empty()) species["vibration"] = facts_of(s.vibration);
  return species;
}

}  // namespace

json report_of(const Computation& computation, const Outcome& outcome) {
  const auto& c = computation.the_case();
  const auto& flow = computation.flow();
  const auto& averaging = computation.averaging();
  const auto& state = averaging.state();
  const auto results = averaging.results();
  const double student = student_95(results.groups.n_groups);
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
                             {"moves", computation.n_moves()},        {"move_seconds", computation.move_seconds()},
                             {"imbalance", ranks.imbalance},          {"particle_imbalance", ranks.particles},
                             {"messages_per_step", ranks.messages},   {"bytes_per_step", ranks.bytes},
                             {"exchanges_per_step", ranks.exchanges}, {"reductions_per_step", ranks.reductions}};
  report["averages"] = averages_of(averaging, results, student);
  const Style style{{results.n_blocks > 0, student}, c.reference.gives_lift(), averaging.scale()};
  report.update(shown(results.body, style));
  report["reference"] = shown(c.reference, averaging.scale());
  for (const auto& species : c.gas.species) report["species"].push_back(shown(species));
  for (const auto& wall : results.walls) report["patches"][wall.patch] = shown(wall, style);
  report["fluxes"] = fluxes_report(computation);
  report["balance"] = balance_report(state.balance);
  report["plan"] = to_json(outcome.plan);
  report["quality"] = to_json(outcome.resolution);
  if (outcome.check) report["resolution"] = to_json(*outcome.check);
  return report;
}

std::string summary_of(const Computation& computation, const Outcome& outcome) {
  const auto results = computation.averaging().results();
  const auto line = fmt::format("{} steps, {} particles, none lost, {:.3g} particle-steps per CPU second",
                                computation.flow().steps_done, outcome.n_particles, outcome.advance.rate());
  if (results.n_blocks == 0 || results.walls.empty()) return line;
  const auto& body = results.body;
  const double student = student_95(results.groups.n_groups);
  const auto bound_of = [&](const char* name, const Estimate& e) {
    if (outcome.check)
      for (const auto& one : outcome.check->coefficients)
        if (one.name == name) return one.bound();
    return student * e.error;
  };
  const auto text = [&](const char* name, const Estimate& e) {
    const auto value = fmt::format("{} {:.4f}", name, e.value);
    return std::isfinite(student) ? fmt::format("{} +- {:.4f}", value, bound_of(name, e)) : value;
  };
  const auto in_units = [&](const char* name, const Estimate& e, double unit) {
    const auto value = fmt::format("{:.4g}", unit * e.value);
    return std::isfinite(student) ? fmt::format("{} +- {:.2g}", value, unit * bound_of(name, e)) : value;
  };
  const auto& scale = computation.averaging().scale();
  const auto lift = computation.the_case().reference.gives_lift()
                        ? fmt::format("{}, {}, ", text("C_L", body.lift), text("C_m", body.moment))
                        : std::string();
  return fmt::format("{}; {} ({} N), {}{} ({} W)", line, text("C_D", body.drag),
                     in_units("C_D", body.drag, scale.force()), lift, text("C_H", body.heat),
                     in_units("C_H", body.heat, scale.force() * scale.speed()));
}

std::vector<std::string> warnings_of(const Averaging& averaging) {
  std::vector<std::string> warnings;
  if (const auto& balance = averaging.state().balance; !balance.holds())
    warnings.push_back("what passed the patches is not what the gas has lost: " + balance_line(balance));
  const auto results = averaging.results();
  if (results.n_blocks == 0)
    warnings.emplace_back("the run has ended before the averages began: there are no coefficients and fluxes");
  const auto& groups = results.groups;
  if (groups.n_groups < 2) return warnings;
  const auto passage = averaging.passage_steps();
  if (groups.steps < passage)
    warnings.push_back(fmt::format(
        "standard errors come from {} groups of {} steps, fewer than the {} in which the flow forgets itself, and "
        "may be too small: for ten that long use sampling = {}",
        groups.n_groups, groups.steps, passage, 20 * ((passage + 1) / 2)));
  if (const auto found = drifts_of(results.trends); !found.empty())
    warnings.push_back(
        fmt::format("the flow was not steady: {} while it was averaged, which standard errors do not show: begin the "
                    "averages later (transient in [run])",
                    found));
  return warnings;
}

std::string summary_of(const Transferred& transferred) {
  return fmt::format("carried {} particles from step {}: {} now inside walls removed, {} particles with the new weight",
                     transferred.old_particles, transferred.step, transferred.removed, transferred.new_particles);
}

}  // namespace pamr::dsmc
