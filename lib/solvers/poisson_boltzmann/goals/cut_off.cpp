// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/poisson_boltzmann/goals/cut_off.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"

namespace pamr::poisson_boltzmann {

namespace {

/// 0 up to `low`, 1 from `high` on, a cubic between; in place.
void ramp(std::vector<double>& values, double low, double high) {
  for (auto& value : values) {
    const double t = std::clamp((value - low) / (high - low), 0.0, 1.0);
    value = t * t * (3 - 2 * t);
  }
}

/// The patches around an electrode.
struct Surroundings {
  std::uint64_t apart = 0;   ///< the cut-off function must be 0 there
  std::uint64_t open = 0;    ///< they meet the electrode and are no mirrors
  int other_electrode = -1;  ///< one that meets it
};

Surroundings surroundings_of(const Problem& problem, const Electrode& electrode) {
  Surroundings result;
  const auto& patches = problem.domain.mesh->info.patches;
  for (std::size_t q = 0; q < patches.size(); ++q) {
    const auto bit = std::uint64_t{1} << q;
    if (problem.domain.patches[q].n_faces == 0 || (electrode.patches & bit) != 0) continue;
    if ((electrode.mirrors.patches & bit) != 0) continue;
    if ((electrode.mirrors.neighbors & bit) == 0) {
      result.apart |= bit;
    } else {
      result.open |= bit;
      if (problem.input.is_electrode(patches[q].name)) result.other_electrode = static_cast<int>(q);
    }
  }
  return result;
}

/// A shell around a sphere as the case states it.
CutOff shell_around(const par::Comm& comm, const Problem& problem, const Electrode& electrode, std::uint64_t apart) {
  const auto& domain = problem.domain;
  const auto& sphere = *electrode.sphere;
  double gap = HUGE_VAL;
  CutOff result;
  result.chi.resize(domain.point.size());
  for (std::size_t i = 0; i < result.chi.size(); ++i) {
    const double distance = norm(domain.point[i] - sphere.center) - sphere.radius;
    if ((domain.node_patches[i] & apart) != 0) gap = std::min(gap, distance);
    result.chi[i] = -distance;
  }
  gap = comm.min(gap);
  result.outer = problem.input.force.outer.value_or(std::min(4.0, 0.95 * gap));
  result.inner = problem.input.force.inner.value_or(0.5 * result.outer);
  if (!(result.outer <= gap) || !(result.inner < result.outer))
    throw Error(
        fmt::format("expected a cut-off function within the {:g} Debye lengths from sphere {} to the nearest "
                    "other boundary, found inner {:g} and outer {:g}",
                    gap, sphere.patch, result.inner, result.outer));
  ramp(result.chi, -result.outer, -result.inner);
  return result;
}

/// Why there is no cut-off function; empty where there is one.
std::string reason_against(const Problem& problem, const Surroundings& around) {
  if (around.other_electrode >= 0)
    return fmt::format(
        "it meets patch \"{}\", which holds a charge or a potential, too (if they are one body, list them in a "
        "[[body]])",
        problem.domain.mesh->info.patches[at(around.other_electrode)].name);
  return around.apart == 0 ? "no boundary lies apart from it" : "";
}

}  // namespace

std::string no_cut_off(const Problem& problem, const Electrode& electrode) {
  return reason_against(problem, surroundings_of(problem, electrode));
}

CutOff make_cut_off(const par::Comm& comm, const Problem& problem, System& system, const Electrode& electrode) {
  const auto& force = problem.input.force;
  CutOff result;
  const auto around = surroundings_of(problem, electrode);
  result.reason = reason_against(problem, around);
  if (!result.reason.empty()) return result;
  if (electrode.sphere != nullptr && around.open == 0 && (force.inner || force.outer))
    return shell_around(comm, problem, electrode, around.apart);
  result.open_walls = around.open;
  result.chi = system.harmonic(electrode.patches, around.apart);
  ramp(result.chi, 0.1, 0.5);
  return result;
}

}  // namespace pamr::poisson_boltzmann
