// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/error_bars.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "pamr/base/index.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/plane_fit.hpp"

namespace pamr::poisson_boltzmann {

namespace {

bool holds_value(const Boundary& b) {
  return b.condition == Condition::potential || b.condition == Condition::charge ||
         b.condition == Condition::regulated || b.condition == Condition::symmetry;
}

/// Sheets of which no bar knows the error. Of the others each side is like a wall.
NoErrorBar why_not_with_sheets(const Problem& problem, const std::vector<Electrode>& electrodes, const Goal& goal) {
  const auto& domain = problem.domain;
  const auto& info = domain.mesh->info;
  const bool is_linear = !domain.quadratic;
  const auto is_curved = [&](std::size_t p) {
    const auto* surface = info.surface_of(static_cast<int>(p));
    return surface != nullptr && !surface->is_flat();
  };
  for (std::size_t p = 0; p < info.patches.size(); ++p) {
    if (!domain.patches[p].has_inside) continue;
    const auto& name = info.patches[p].name;
    if (domain.patches[p].has_rim)
      return {fmt::format("it does not hold where patch {} ends in the liquid", name), !is_linear};
    const bool is_pushed = std::any_of(electrodes.begin(), electrodes.end(), [&](const Electrode& e) {
      return e.name == goal.body && e.has(static_cast<int>(p));
    });
    if (is_linear && is_pushed && (goal.kind == Goal::Kind::force || goal.kind == Goal::Kind::torque))
      return {fmt::format("that of what acts on patch {} is too small: use order = 2", name), false};
    const bool has_charge = problem.input.find_boundary(name)->holds_charge();
    if (is_curved(p) && (is_linear || has_charge))
      return {fmt::format("it would not contain the curvature of patch {}", name) +
              (has_charge ? "" : ": use order = 2")};
    const auto own =
        std::find_if(electrodes.begin(), electrodes.end(), [&](const Electrode& e) { return e.name == name; });
    const auto meets = [&](std::size_t q) {
      return own != electrodes.end() && (own->mirrors.neighbors >> q & 1U) != 0;
    };
    for (std::size_t q = 0; q < info.patches.size(); ++q) {
      if (!meets(q)) continue;
      if (has_charge && is_curved(q))
        return {fmt::format("it would not contain the edge of patch {} at the curved patch {}", name,
                            info.patches[q].name)};
      if (is_linear && goal.kind == Goal::Kind::midplane && info.patches[q].name == problem.input.force.midplane)
        return {fmt::format("it does not hold where patch {} meets the mid-plane: use order = 2", name), false};
    }
  }
  return {};
}

/// The gradient is as the reciprocal of the distance to a line where the potential jumps: charges of the patches that meet
/// there, the stress on them and the energy have no limit as cells shrink.
std::string why_not_with_jumps(const Problem& problem, const std::vector<Electrode>& electrodes, const Goal& goal) {
  const auto& patches = problem.domain.mesh->info.patches;
  const auto body =
      std::find_if(electrodes.begin(), electrodes.end(), [&](const Electrode& e) { return e.name == goal.body; });
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (problem.conditions.contradictions_on[p] == 0) continue;
    const bool is_own = goal.kind == Goal::Kind::energy ||
                        (goal.kind == Goal::Kind::midplane && patches[p].name == problem.input.force.midplane) ||
                        (body != electrodes.end() && body->has(static_cast<int>(p)));
    if (is_own)
      return fmt::format("the exact value is infinite: patch {} meets a different potential", patches[p].name);
  }
  return "";
}

std::string why_not_of_second_order(const Problem& problem, const std::vector<bool>& has_facets) {
  const auto& info = problem.domain.mesh->info;
  for (std::size_t p = 0; p < info.patches.size(); ++p)
    if (has_facets[p])
      return fmt::format(
          "it would not contain the facets of patch {}, which has no surface and is not flat: describe its surface, or "
          "make each flat side a patch",
          info.patches[p].name);
  return "";
}

/// A number that is larger than `limit`, with as many digits as show it.
std::string digits_above(double value, double limit) {
  std::string text;
  for (int digits = 2; digits <= 17; ++digits) {
    text = fmt::format("{:.{}g}", value, digits);
    if (std::stod(text) > limit) break;
  }
  return text;
}

std::string why_not_of_first_order(const Problem& problem, const std::vector<Electrode>& electrodes,
                                   const Layers& layers, const Goal& goal) {
  if (problem.input.solver.quadrature == Quadrature::gauss &&
      (goal.kind == Goal::Kind::force || goal.kind == Goal::Kind::torque))
    return "that of a volume form by Gauss points is too small: use quadrature = \"nodal\" or order = 2";
  const auto& patches = problem.domain.mesh->info.patches;
  const auto body =
      std::find_if(electrodes.begin(), electrodes.end(), [&](const Electrode& e) { return e.name == goal.body; });
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const auto& layer = layers.patches[p];
    if (layer.is_known) continue;
    const bool is_own = goal.kind == Goal::Kind::charge && body != electrodes.end() && body->has(static_cast<int>(p));
    const auto* b = problem.input.find_boundary(patches[p].name);
    const bool is_charged = is_own || b->holds_charge();
    const double most = is_charged ? largest_ratio_of_charge_bar : largest_resolved_layer_ratio;
    if (layer.ratio > most)
      return fmt::format(
          "the cells at patch {} are {} layers high, the bar holds up to {:g}: refine there or use order = 2",
          patches[p].name, digits_above(layer.ratio, most), most);
  }
  return "";
}

/// Of each patch with sides of sheets whether their normals are parallel. Collective: two reductions.
std::vector<bool> have_parallel_sides(const par::Comm& comm, const Domain& domain) {
  constexpr std::size_t n = 6;
  const auto n_patches = domain.patches.size();
  std::vector<double> highest(2 * n * n_patches, -HUGE_VAL);
  for (const auto& face : domain.faces) {
    if (!face.is_inside) continue;
    const auto v = face.normal;
    const std::array<double, n> product{v.x * v.x, v.y * v.y, v.z * v.z, v.x * v.y, v.y * v.z, v.z * v.x};
    for (std::size_t k = 0; k < n; ++k) {
      auto* pair = &highest[2 * (n * at(face.patch) + k)];
      pair[0] = std::max(pair[0], product[k]);
      pair[1] = std::max(pair[1], -product[k]);
    }
  }
  comm.max_in_place(highest);
  std::vector<bool> result(n_patches, true);
  for (std::size_t i = 0; i < highest.size(); i += 2)
    if (highest[i] + highest[i + 1] > 1e-9) result[i / (2 * n)] = false;
  return result;
}

}  // namespace

std::vector<bool> find_facets(const par::Comm& comm, const Problem& problem) {
  const auto& mesh = *problem.domain.mesh;
  const auto& patches = mesh.info.patches;
  std::vector<bool> result(patches.size(), false);
  if (!problem.domain.quadratic) return result;
  for (std::size_t p = 0; p < patches.size(); ++p)
    result[p] = mesh.info.surface_of(static_cast<int>(p)) == nullptr && problem.domain.patches[p].area > 0 &&
                holds_value(*problem.input.find_boundary(patches[p].name));
  const auto planes = mesh::fit_planes(comm, mesh, result);
  const auto is_parallel = have_parallel_sides(comm, problem.domain);
  for (std::size_t p = 0; p < patches.size(); ++p) {
    const bool is_flat = problem.domain.patches[p].has_inside ? is_parallel[p] : planes[p].is_flat;
    result[p] = result[p] && !is_flat;
  }
  return result;
}

NoErrorBar why_no_error_bar(const Problem& problem, const std::vector<Electrode>& electrodes, const Layers& layers,
                            const std::vector<bool>& has_facets, const Goal& goal) {
  const auto of_jumps = why_not_with_jumps(problem, electrodes, goal);
  if (!of_jumps.empty()) return {of_jumps, false};
  const auto of_sheets = why_not_with_sheets(problem, electrodes, goal);
  if (!of_sheets.reason.empty()) return of_sheets;
  return {problem.domain.quadratic ? why_not_of_second_order(problem, has_facets)
                                   : why_not_of_first_order(problem, electrodes, layers, goal)};
}

std::string beyond_error_bars(const Case& input) {
  const auto is_body = [&](const Boundary& b) {
    return input.is_electrode(b.patch) && !(input.plate && b.patch == input.plate->patch);
  };
  const bool has_body = std::any_of(input.boundary.begin(), input.boundary.end(), is_body);
  for (const auto& b : input.boundary)
    if (b.condition == Condition::plate_profile && has_body)
      return "the bar does not contain the walls at plate-profile";
  return "";
}

}  // namespace pamr::poisson_boltzmann
