// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/pb_report.hpp"

#include <fmt/format.h>

#include <cmath>
#include <nlohmann/json.hpp>

namespace pamr::poisson_boltzmann {

using geometry::Vec3;
using nlohmann::json;

namespace {

json force_json(const std::optional<Vec3>& force, double unit) {
  if (!force) return nullptr;
  return {{"dimensionless", {force->x, force->y, force->z}},
          {"newton", {unit * force->x, unit * force->y, unit * force->z}}};
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
              {"first_residual", solution.first_residual},
              {"energy", analysis.energy.total},
              {"excess_energy", analysis.energy.excess}};
  report["units"] = {{"force_newton", units.force}, {"potential_volt", units.potential}};
  report["units"]["length_meter"] = units.length ? json(*units.length) : json(nullptr);
  for (const auto& step : solution.steps)
    report["convergence"].push_back({{"step", step.step},
                                     {"residual", step.residual},
                                     {"largest_change", step.largest_change},
                                     {"linear_iterations", step.linear_iterations}});
  for (const auto& patch : analysis.patches) {
    auto& force = report["forces"][patch.name];
    force["surface"] = force_json(patch.surface, units.force);
    force["surface_recovered"] = force_json(patch.surface_recovered, units.force);
    force["surface_reaction"] = force_json(patch.surface_reaction, units.force);
    force["volume"] = force_json(patch.volume, units.force);
    force["midplane"] = force_json(patch.midplane, units.force);
    force["symmetry_factor"] = patch.symmetry_factor;
    if (patch.volume) force["cut_off"] = {patch.inner, patch.outer};
    report["charges"][patch.name] = patch.charge;
    report["charge_densities"][patch.name] = patch.charge_density;
    report["areas"][patch.name] = patch.area;
  }
  const double norm = std::sqrt(estimate.norm_squared);
  report["error_estimate"] = {{"recovered", std::sqrt(estimate.total_squared)},
                              {"relative", norm > 0 ? std::sqrt(estimate.total_squared) / norm : 0.0},
                              {"relative_squared", norm > 0 ? estimate.total_squared / estimate.norm_squared : 0.0},
                              {"residual", std::sqrt(estimate.residual_total_squared)},
                              {"norm", norm}};
  report["force_error"] = nullptr;
  if (input.estimator.goal != "none") {
    report["goal"] = {{"name", input.estimator.goal},
                      {"value", analysis.goal_value},
                      {"error_bound", analysis.goal_error},
                      {"correction", analysis.goal_correction}};
    if (input.estimator.goal != "charge") report["force_error"] = std::abs(analysis.goal_correction);
  }
  if (analysis.manufactured_l2)
    report["manufactured"] = {{"l2_error", *analysis.manufactured_l2}, {"h1_error", *analysis.manufactured_h1}};
  return report;
}

std::vector<std::string> describe_results(const Case& input, const Analysis& analysis) {
  std::vector<std::string> lines;
  const double unit = units_of(input.electrolyte).force;
  for (const auto& patch : analysis.patches) {
    const auto* boundary = input.find_boundary(patch.name);
    if (boundary == nullptr || boundary->condition == Condition::symmetry) continue;
    lines.push_back(fmt::format("patch {}: charge {:.9g} (symmetry factor {:g}), mean density {:.9g} on area {:.6g}",
                                patch.name, patch.charge, patch.symmetry_factor, patch.charge_density, patch.area));
    for (const auto& line : {shown("surface", patch.surface, unit), shown("recovered", patch.surface_recovered, unit),
                             shown("reaction", patch.surface_reaction, unit), shown("volume", patch.volume, unit),
                             shown("midplane", patch.midplane, unit)})
      if (!line.empty()) lines.push_back(line);
    if (patch.volume)
      lines.push_back(
          fmt::format("  cut-off function 1 within {:.4g}, 0 beyond {:.4g} of the surface", patch.inner, patch.outer));
  }
  const auto& estimate = analysis.estimate;
  lines.push_back(fmt::format("energy {:.10g}, less that of the plate profile {:.10g}", analysis.energy.total,
                              analysis.energy.excess));
  if (estimate.norm_squared > 0)
    lines.push_back(fmt::format("estimated error of the gradient {:.4e}, relative {:.4e}, sum e_K^2 / |E|^2 = {:.4e}",
                                std::sqrt(estimate.total_squared),
                                std::sqrt(estimate.total_squared / estimate.norm_squared),
                                estimate.total_squared / estimate.norm_squared));
  if (input.estimator.goal != "none")
    lines.push_back(fmt::format("goal {} = {:.9g}, estimated error {:.3e}, sum of the cells' shares {:.3e}",
                                input.estimator.goal, analysis.goal_value, analysis.goal_correction,
                                analysis.goal_error));
  if (analysis.manufactured_l2)
    lines.push_back(fmt::format("manufactured solution: error {:.6e} (L2), {:.6e} (H1)", *analysis.manufactured_l2,
                                *analysis.manufactured_h1));
  return lines;
}

std::string describe_failure(const Solution& s) {
  return fmt::format(
      "not converged after {} Newton steps ({}): residual {:.3e} of {:.3e} at the start; largest, {:.3e}, at node {} "
      "({:g}, {:g}, {:g}); nothing is written",
      s.newton_iterations, s.reason, s.residual, s.first_residual, s.worst_residual, s.worst_node, s.worst_point.x,
      s.worst_point.y, s.worst_point.z);
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
