// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/report/pb_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "solvers/poisson_boltzmann/goals/error_bars.hpp"
#include "solvers/poisson_boltzmann/report/best_values.hpp"

namespace pamr::poisson_boltzmann {

using geometry::Vec3;
using nlohmann::json;

namespace {

json force_json(const std::optional<Vec3>& force, double unit) {
  if (!force) return nullptr;
  return {{"dimensionless", {force->x, force->y, force->z}},
          {"newton", {unit * force->x, unit * force->y, unit * force->z}}};
}

json number_json(const std::optional<double>& value) { return value ? json(*value) : json(nullptr); }
json text_json(const std::string& text) { return text.empty() ? json(nullptr) : json(text); }

json goal_json(const GoalResult& result) {
  return {{"name", result.goal.name},
          {"body", result.goal.body},
          {"value", result.value ? json(*result.value) : json(nullptr)},
          {"error_bound", result.error_bound},
          {"correction", result.correction},
          {"corrected", result.value && result.is_corrected ? json(*result.value + result.correction) : json(nullptr)},
          {"error_bar", number_json(result.error_bar)},
          {"box_error", result.of_box},
          {"coarse", result.is_coarse},
          {"error_withheld", text_json(result.no_error_bar)}};
}

/// What newtons, or newton meters, one unit of the quantity is; nothing for others.
std::optional<double> unit_of(const std::string& quantity, const Units& units) {
  if (quantity.rfind("force", 0) == 0) return units.force;
  if (quantity.rfind("torque", 0) == 0) return units.energy;
  return quantity == "charge" ? units.charge : std::nullopt;
}
const char* unit_name(const std::string& quantity) {
  return quantity.rfind("force", 0) == 0 ? "N" : quantity.rfind("torque", 0) == 0 ? "N m" : "C";
}

/// Mean share of the sites of a regulated patch that carry their charge; nothing for others.
std::optional<double> charged_share(const Case& input, const PatchResult& patch) {
  const auto* b = input.find_boundary(patch.name);
  if (b == nullptr || b->condition != Condition::regulated || !patch.charge_density) return std::nullopt;
  return *patch.charge_density / b->site.density;
}

/// A patch inside without a condition has no results.
bool is_open(const Case& input, const PatchResult& patch) {
  return patch.electrode == nullptr && input.find_boundary(patch.name) == nullptr;
}

void add_patch(const Case& input, const Analysis& analysis, const PatchResult& patch, json& report) {
  const auto units = units_of(input.electrolyte);
  auto& force = report["forces"][patch.name];
  force["surface"] = force_json(patch.surface, units.force);
  force["surface_recovered"] = force_json(patch.surface_recovered, units.force);
  force["surface_reaction"] = force_json(patch.surface_reaction, units.force);
  force["volume"] = force_json(patch.volume, units.force);
  force["midplane"] = force_json(patch.midplane, units.force);
  force["symmetry_factor"] = patch.symmetry_factor;
  force["torque"] = nullptr;
  if (patch.torque)
    force["torque"] = {{"dimensionless", {patch.torque->x, patch.torque->y, patch.torque->z}},
                       {"center", {patch.electrode->center.x, patch.electrode->center.y, patch.electrode->center.z}}};
  if (patch.outer > 0) force["cut_off"] = {patch.inner, patch.outer};
  if (!patch.no_volume.empty()) force["no_volume"] = patch.no_volume;
  report["charges"][patch.name] = number_json(patch.charge);
  report["charge_densities"][patch.name] = number_json(patch.charge_density);
  report["mean_potentials"][patch.name] = patch.mean_potential;
  if (const auto share = charged_share(input, patch)) report["charged_sites"][patch.name] = *share;
  report["areas"][patch.name] = patch.area;
  if (patch.electrode != nullptr)
    report["layers"][patch.name] = {{"thickness", patch.layer.thickness},
                                    {"cell_height", patch.layer.height},
                                    {"ratio", patch.layer.ratio},
                                    {"cells_needed", patch.layer.n_cells},
                                    {"resolved", patch.layer.is_known || patch.layer.is_resolved()}};
  for (const auto& best : best_values(input, analysis, patch)) {
    auto& entry = report["best"][patch.name][best.quantity];
    entry = {{"value", best.value}, {"error", number_json(best.error)}, {"from", best.from}};
    if (best.is_goal) {
      entry["error_withheld"] = text_json(best.no_error);
      entry["box_error"] = best.of_box;
    }
    if (const auto unit = unit_of(best.quantity, units)) entry["si"] = *unit * best.value;
  }
}

/// A line with one form of a force, dimensionless and in newtons; empty where the patch has no such form.
std::string shown(const char* form, const std::optional<Vec3>& force, double unit) {
  if (!force) return "";
  return fmt::format("  {:<9} {:>13.6e} {:>13.6e} {:>13.6e}   {:>11.4e} {:>11.4e} {:>11.4e} N", form, force->x,
                     force->y, force->z, unit * force->x, unit * force->y, unit * force->z);
}

}  // namespace

json report_of(const Domain& domain, const Case& input, const Solution& solution, const Analysis& analysis) {
  const auto units = units_of(input.electrolyte);
  const auto& estimate = analysis.estimate;
  json report{{"nodes", domain.mesh->info.n_global_nodes},
              {"cells", domain.mesh->info.n_global_cells},
              {"converged", solution.converged},
              {"newton_iterations", solution.newton_iterations},
              {"linear_iterations", solution.linear_iterations},
              {"residual", solution.residual},
              {"first_residual", solution.first_residual}};
  report["order"] = int{input.solver.order};
  report["unknowns"] = domain.n_global_nodes();
  if (domain.quadratic) {
    const auto& curving = domain.quadratic->report;
    report["curved_edges"] = curving.n_curved_edges;
    report["straightened_edges"] = curving.straightening.n_edges;
    report["min_jacobian"] = curving.straightening.min_jacobian;
  }
  report["energy"] = analysis.energy ? json(analysis.energy->total) : json(nullptr);
  report["excess_energy"] = analysis.energy ? json(analysis.energy->excess) : json(nullptr);
  report["free_energy"] = nullptr;
  if (const auto& free = analysis.free_energy)
    report["free_energy"] = {{"fixed_potential", free->fixed_potential},
                             {"fixed_charge", free->fixed_charge},
                             {"as_stated", free->as_stated}};
  report["units"] = {{"force_newton", units.force}, {"potential_volt", units.potential}};
  report["units"]["length_meter"] = units.length ? json(*units.length) : json(nullptr);
  for (const auto& step : solution.steps)
    report["convergence"].push_back({{"step", step.step},
                                     {"residual", step.residual},
                                     {"largest_change", step.largest_change},
                                     {"linear_iterations", step.linear_iterations}});
  for (const auto& patch : analysis.patches)
    if (!is_open(input, patch)) add_patch(input, analysis, patch, report);
  const double norm = std::sqrt(estimate.norm_squared);
  report["error_estimate"] = {{"recovered", std::sqrt(estimate.total_squared)},
                              {"relative", norm > 0 ? std::sqrt(estimate.total_squared) / norm : 0.0},
                              {"relative_squared", norm > 0 ? estimate.total_squared / estimate.norm_squared : 0.0},
                              {"residual", std::sqrt(estimate.residual_total_squared)},
                              {"norm", norm}};
  report["beyond_error_bars"] = text_json(beyond_error_bars(input));
  report["force_error"] = nullptr;
  for (const auto& goal : analysis.goals) report["goals"].push_back(goal_json(goal));
  if (!analysis.goals.empty()) {
    report["goal"] = report["goals"][0];
    const auto kind = analysis.goals[0].goal.kind;
    if (kind == Goal::Kind::force || kind == Goal::Kind::midplane)
      report["force_error"] = std::abs(analysis.goals[0].correction);
  }
  if (analysis.manufactured_l2)
    report["manufactured"] = {{"l2_error", *analysis.manufactured_l2}, {"h1_error", *analysis.manufactured_h1}};
  return report;
}

std::string with_error(double value, const std::optional<double>& error) {
  if (!error) return fmt::format("{:.6g}", value);
  if (!(*error > 0) || value == 0) return fmt::format("{:.6g} +- {:.2g}", value, *error);
  const auto place = [](double x) { return static_cast<int>(std::floor(std::log10(std::abs(x)))); };
  const int digits = std::max(0, 1 - place(*error));
  if (digits <= 6 && *error < 1e6) return fmt::format("{:.{}f} +- {:.{}f}", value, digits, *error, digits);
  return fmt::format("{:.{}g} +- {:.2g}", value, std::clamp(place(value) - place(*error) + 2, 1, 17), *error);
}

namespace {

/// Whether a patch, or one of a body's, has a given potential.
bool has_potential(const Case& input, const std::string& name) {
  const auto is_potential = [&](const std::string& patch) {
    const auto* boundary = input.find_boundary(patch);
    return boundary != nullptr && boundary->condition == Condition::potential;
  };
  const auto is_body = [&](const auto& body) {
    return body.name == name && std::any_of(body.patches.begin(), body.patches.end(), is_potential);
  };
  return is_potential(name) || std::any_of(input.bodies.begin(), input.bodies.end(), is_body);
}

/// A warning if a charge without a correction is too large because the cells are too high for the layer; else empty.
std::string beside_charge(const Case& input, const PatchResult& patch, const BestValue& best) {
  const auto& layer = patch.layer;
  if (best.quantity != "charge" || best.is_goal || input.solver.order != 1 || layer.is_known ||
      !has_potential(input, patch.name) || layer.ratio <= largest_ratio_of_charge_bar)
    return "";
  return fmt::format("; may be {:.2g} % too large: cells {:.2g} layers high, use order = 2", layer.excess_percent(),
                     layer.ratio);
}

/// What a reader of the value has to know of its error bar: why there is none, or what it lacks.
std::string beside_error(const Case& input, const std::optional<double>& error, const std::string& no_error,
                         double of_box, bool is_coarse) {
  const auto beyond = error ? beyond_error_bars(input) : "no error bar: " + no_error;
  return (error && of_box > 0 ? fmt::format("; {:.2g} of it for the box", of_box) : "") +
         (error && is_coarse ? "; coarse mesh: compare two levels" : "") + (beyond.empty() ? "" : "; " + beyond);
}

void describe_patch(const Case& input, const Analysis& analysis, const PatchResult& patch,
                    std::vector<std::string>& lines) {
  const auto* boundary = input.find_boundary(patch.name);
  if (boundary != nullptr && boundary->condition == Condition::symmetry && !patch.midplane) return;
  const auto units = units_of(input.electrolyte);
  lines.push_back(fmt::format("{} {}: area {:.6g}, mean potential {:.7g}, symmetry factor {:g}",
                              boundary == nullptr ? "body" : "patch", patch.name, patch.area, patch.mean_potential,
                              patch.symmetry_factor));
  for (const auto& best : best_values(input, analysis, patch)) {
    const auto unit = unit_of(best.quantity, units);
    lines.push_back(fmt::format("  best {:<9} {}{}  ({}{}{}{})", best.quantity, with_error(best.value, best.error),
                                unit ? fmt::format("  {:.4e} {}", *unit * best.value, unit_name(best.quantity)) : "",
                                best.from,
                                best.is_corrected ? ", corrected"
                                : best.is_goal    ? ", not corrected"
                                                  : "",
                                beside_error(input, best.error, best.no_error, best.of_box, best.is_coarse),
                                beside_charge(input, patch, best)));
  }
  if (patch.charge) {
    const auto share = charged_share(input, patch);
    lines.push_back(fmt::format("  charge    {:.9g}, mean density {:.9g}{}", *patch.charge, *patch.charge_density,
                                share ? fmt::format(", {:.4g} of the sites charged", *share) : ""));
  }
  for (const auto& line :
       {shown("surface", patch.surface, units.force), shown("recovered", patch.surface_recovered, units.force),
        shown("reaction", patch.surface_reaction, units.force), shown("volume", patch.volume, units.force),
        shown("midplane", patch.midplane, units.force)})
    if (!line.empty()) lines.push_back(line);
  if (patch.outer > 0)
    lines.push_back(
        fmt::format("  cut-off function 1 within {:.4g}, 0 beyond {:.4g} of the surface", patch.inner, patch.outer));
  if (patch.layer.is_lost && patch.layer.is_known)
    lines.push_back(fmt::format("  no surface forms: the cells are {:.3g} Debye lengths high, the layer {:.3g}",
                                patch.layer.height, patch.layer.thickness));
  if (!patch.no_volume.empty()) lines.push_back("  no volume form: " + patch.no_volume);
}

}  // namespace

std::vector<std::string> describe_results(const Case& input, const Analysis& analysis) {
  std::vector<std::string> lines;
  for (const auto& patch : analysis.patches)
    if (!is_open(input, patch)) describe_patch(input, analysis, patch, lines);
  if (!analysis.no_midplane.empty()) lines.push_back("mid-plane: " + analysis.no_midplane);
  const auto& estimate = analysis.estimate;
  if (analysis.energy)
    lines.push_back(fmt::format("energy {:.10g}", analysis.energy->total) +
                    (input.plate ? fmt::format(", less that of the plate profile {:.10g}", analysis.energy->excess)
                                 : std::string()));
  if (const auto& free = analysis.free_energy)
    lines.push_back(fmt::format("free energy {:.10g} at fixed potential, {:.10g} at fixed charge, {:.10g} as stated",
                                free->fixed_potential, free->fixed_charge, free->as_stated));
  if (estimate.norm_squared > 0)
    lines.push_back(fmt::format("estimated error of the gradient {:.4e}, relative {:.4e}, sum e_K^2 / |E|^2 = {:.4e}",
                                std::sqrt(estimate.total_squared),
                                std::sqrt(estimate.total_squared / estimate.norm_squared),
                                estimate.total_squared / estimate.norm_squared));
  for (const auto& result : analysis.goals)
    lines.push_back(
        fmt::format("goal {}{} = {}, estimated error {:.3e}, sum of the cells' shares {:.3e}{}{}", result.goal.name,
                    result.goal.body.empty() ? "" : " of " + result.goal.body,
                    result.value ? fmt::format("{:.9g}", *result.value) : "not given", result.correction,
                    result.error_bound, result.error_bar ? fmt::format(", error bar {:.2g}", *result.error_bar) : "",
                    beside_error(input, result.error_bar, result.no_error_bar, result.of_box, result.is_coarse)));
  if (analysis.manufactured_l2)
    lines.push_back(fmt::format("manufactured solution: error {:.6e} (L2), {:.6e} (H1)", *analysis.manufactured_l2,
                                *analysis.manufactured_h1));
  return lines;
}

std::vector<std::string> describe_layers(const Case& input, const Analysis& analysis) {
  std::vector<std::string> lines;
  for (const auto& patch : analysis.patches) {
    const auto& layer = patch.layer;
    const auto* boundary = input.find_boundary(patch.name);
    const bool is_patch =
        patch.electrode != nullptr && boundary != nullptr;  // a body's patches have lines of their own
    if (!is_patch || layer.is_resolved() || layer.is_known) continue;
    auto line = fmt::format(
        "patch {}: its layer is not resolved: cells {:.3g} Debye lengths high, the layer {:.3g} (1/cosh(psi/2)); a "
        "mesh that resolves it takes some {:.1e} cells at the patch",
        patch.name, layer.height, layer.thickness, layer.n_cells);
    if (layer.is_lost)
      line += "; its charge, the force on it and the energy are not given";
    else if (boundary->condition == Condition::regulated)
      line += "; its charge and its potential may be off";
    else if (boundary->condition == Condition::charge)
      line += "; its charge is given, its potential may be too low";
    else
      line += fmt::format("; its charge may be {:.0f} % too large", layer.excess_percent());
    line += " (mark the cells with pamr-mark --field layer_ratio --above 1)";
    lines.push_back(std::move(line));
  }
  return lines;
}

std::string describe_failure(const Solution& s) {
  return fmt::format(
      "not converged after {} Newton steps ({}): residual {:.3e}, {:.3e} at the start, {:.3e} wanted; largest, "
      "{:.3e}, at node {} ({:g}, {:g}, {:g})",
      s.newton_iterations, s.reason, s.residual, s.first_residual, s.tolerance, s.worst_residual, s.worst_node,
      s.worst_point.x, s.worst_point.y, s.worst_point.z);
}

json failure_report(const Solution& solution) {
  return {{"converged", false},
          {"reason", solution.reason},
          {"residual", solution.residual},
          {"newton_iterations", solution.newton_iterations},
          {"worst_node", solution.worst_node}};
}

json seconds_of(std::span<const StepTime> steps, double StepTime::*seconds) {
  auto result = json::object();
  double total = 0;
  for (const auto& step : steps) {
    result[step.step] = step.*seconds;
    total += step.*seconds;
  }
  result["total"] = total;
  return result;
}

std::string table_head() { return "  Newton      residual  largest change   CG iterations"; }

std::string table_line(const NewtonStep& step) {
  return fmt::format("  {:>6}  {:>12.4e}  {:>14.4e}  {:>14}", step.step, step.residual, step.largest_change,
                     step.linear_iterations);
}

}  // namespace pamr::poisson_boltzmann
