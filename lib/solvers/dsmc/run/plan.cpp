// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/plan.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <nlohmann/json.hpp>

#include "pamr/base/index.hpp"
#include "solvers/dsmc/gas/kinetic_theory.hpp"
#include "solvers/dsmc/run/make_setup.hpp"
#include "solvers/dsmc/state/checkpoint_rows.hpp"

namespace pamr::dsmc {

using namespace geometry;

namespace {

constexpr double bytes_per_particle = 96;
constexpr double cell_bytes = 148 + 44 + 40 + 72 + 48;  ///< planes, mesh, collisions, samples, fields
constexpr double typical_rate = 4e6;

std::string rotation_text(const Rotation& r) {
  if (r.model == Rotation::Model::probability) return fmt::format("probability {:g} a molecule", r.value);
  if (r.model == Rotation::Model::z_continuum) return fmt::format("continuum relaxation number {:g}", r.value);
  return fmt::format("relaxation number of Parker, Z_inf {:g}, T* {:g} K", r.z_infinity, r.t_star);
}

std::string vibration_text(const Species& s) {
  std::string modes;
  for (const double theta : s.vibration.mode) modes += fmt::format("{}{:g}", modes.empty() ? "" : ", ", theta);
  auto text = fmt::format("vibration of {}: modes of {} K, relaxes in {:g} T^-{:g} exp({:g} T^(-1/3)) collisions",
                          s.name, modes, s.vibration.c1, s.omega, s.vibration.c2);
  if (s.vibration.cross_section > 0) text += fmt::format(" (limit: {:g} m2 at 50,000 K)", s.vibration.cross_section);
  return text;
}

/// The first stream with a total temperature, or wall with a temperature, at which the gas `is_hot`, in words.
std::string hot_part(const Case& c, const Setup& setup, const std::vector<mesh::Patch>& patches) {
  for (const auto& stream : c.stream) {
    Gas gas = c.gas;
    gas.fraction = stream.fraction;
    const double ratio = gas.heat_ratio(stream.temperature), t = stream.temperature;
    const double speed = norm(stream.velocity);
    const double total = t + (ratio - 1) / (2 * ratio) * mean_species(gas).mass * speed * speed / boltzmann;
    if (is_hot(gas, total))
      return fmt::format("the total temperature of {} is {:.0f} K",
                         &stream == &c.stream.front() ? "the free stream" : "stream " + stream.name, total);
  }
  for (std::size_t p = 0; p < setup.patch.size(); ++p)
    if (setup.patch[p].is_wall() && is_hot(c.gas, setup.patch[p].temperature))
      return fmt::format("the wall {} has {:.0f} K", patches[p].name, setup.patch[p].temperature);
  return {};
}

}  // namespace

Plan make_plan(const par::Comm& comm, const Case& c, const Setup& setup, const mesh::DistMesh& mesh,
               const Checkpoints& checkpoints) {
  const auto& from = checkpoints.from;
  if (!from) require_regions(comm, c, setup, mesh);
  Plan plan;
  const auto& free = c.stream.front();
  Gas gas = c.gas;
  gas.fraction = free.fraction;
  const auto mean = mean_species(gas);
  const double speed = norm(free.velocity);
  const double fast = speed + most_probable_speed(free.temperature, mean.mass);
  plan.mach = speed / std::sqrt(gas.heat_ratio(free.temperature) * boltzmann * free.temperature / mean.mass);
  plan.speed_ratio = speed / most_probable_speed(free.temperature, mean.mass);
  if (c.collisions.enabled) plan.hot_part = hot_part(c, setup, setup.patches_on(mesh));
  plan.missing_when_hot = missing_when_hot(gas);
  if (free.density > 0) {
    plan.mean_free_path = mean_free_path(mean, free.density, free.temperature);
    plan.collision_time = 1 / collision_frequency(mean, free.density, free.temperature);
    plan.knudsen = plan.mean_free_path / c.reference.length;
    plan.reynolds = free.density * mean.mass * speed * c.reference.length / viscosity(mean, free.temperature);
  }
  double longest = 0;
  for (LocalId cell = 0; cell < mesh.n_cells(); ++cell) {
    const double v = volume(corners(mesh, setup.unit, cell));
    const double dt = setup.cell_dt.empty() ? setup.dt : setup.cell_dt[at(cell)];
    longest = std::max(longest, fast * dt / std::cbrt(v));
  }
  plan.longest_flight = comm.max(longest);
  plan.particles = setup.expected_particles;
  const double cells = static_cast<double>(mesh.info.n_global_cells);
  plan.particles_per_cell = plan.particles / cells;
  if (from) plan.particles_at_start = static_cast<double>(from->n_particles) * from->fnum / setup.fnum;
  const double copy_bytes = 8.0 * static_cast<double>(particle_words(gas.is_vibrating));
  plan.particle_bytes = bytes_per_particle + (gas.is_vibrating ? 4 : 0) +
                        (checkpoints.are_written || c.adaptation.every > 0 ? copy_bytes : 0);
  plan.bytes = plan.max_particles() * plan.particle_bytes + cells * cell_bytes;
  plan.steps = static_cast<double>(c.schedule.sampling + c.schedule.transient.value_or(0));
  plan.cpu_seconds = plan.max_particles() * plan.steps / typical_rate;

  plan.gives_lift = c.reference.gives_lift();
  constexpr double tilt_of_facets = 0.1;  // of a curved wall that moves along itself
  const auto& patches = setup.patches_on(mesh);
  std::vector<bool> moves;
  for (const auto& patch : setup.patch) moves.push_back(patch.is_wall() && norm(patch.velocity) > 0);
  const bool any_moves = std::find(moves.begin(), moves.end(), true) != moves.end();
  const bool is_body = has_body(c, setup, patches);
  if (!is_body && !any_moves) return plan;
  const auto domain = make_gas_domain(mesh, setup.unit, setup.dt, setup.fnum, setup.inner_wall);
  if (any_moves)
    if (const auto p = patch_that_leaves_its_plane(comm, domain.boundary, setup.patch, moves, tilt_of_facets); p >= 0)
      plan.wall_out_of_plane = patches[at(p)].name;
  if (is_body) plan.body = body_laws(comm, c, setup, patches, domain.boundary);
  return plan;
}

std::vector<std::string> warnings_of(const Plan& plan) {
  std::vector<std::string> warnings;
  if (plan.longest_flight > 2)
    warnings.push_back(
        fmt::format("a fast molecule of the free stream passes {:.1f} cell sizes in one time step; the result "
                    "stays sound but coarse: use a shorter step",
                    plan.longest_flight));
  if (plan.particles_per_cell < 5)
    warnings.push_back(fmt::format("{:.2g} particles a cell in the free stream: below 5 collisions are poorly resolved",
                                   plan.particles_per_cell));
  if (!plan.wall_out_of_plane.empty())
    warnings.push_back(
        fmt::format("the velocity of the wall {} leads out of its plane: molecules hit it as if it came "
                    "towards them or went away, but it stays in its place",
                    plan.wall_out_of_plane));
  if (!plan.hot_part.empty()) warnings.push_back(fmt::format("{}: {}", plan.hot_part, plan.missing_when_hot));
  return warnings;
}

std::vector<std::string> describe(const Case& c, const Setup& setup, const Plan& plan) {
  std::vector<std::string> lines;
  const auto& free = c.stream.front();
  for (std::size_t i = 0; i < c.gas.species.size(); ++i) {
    const auto& s = c.gas.species[i];
    lines.push_back(
        fmt::format("species {}: {:g} of the molecules, mass {:g} kg, diameter {:g} m at {:g} K, omega {:g}, "
                    "alpha {:g} ({}), {} rotational degrees",
                    s.name, free.fraction[i], s.mass, s.diameter, s.t_ref, s.omega, s.alpha,
                    s.alpha == 1 ? "VHS" : "VSS", s.rotational_degrees));
    if (c.gas.is_weighted) lines.back() += fmt::format(", weight {:g}", s.weight);
  }
  lines.push_back("rotation: " + rotation_text(c.gas.rotation));
  for (const auto& s : c.gas.species)
    if (!s.vibration.mode.empty()) lines.push_back(vibration_text(s));
  lines.push_back(fmt::format("free stream: n {:g} 1/m3, T {:g} K, T_rot {:g} K, u ({:g}, {:g}, {:g}) m/s",
                              free.density, free.temperature, free.rotational_temperature, free.velocity.x,
                              free.velocity.y, free.velocity.z));
  lines.push_back(
      fmt::format("Ma {:.4g}, speed ratio {:.4g}, Kn {:.4g}, Re {:.4g} on {:g} m; mean free path {:.4g} m, "
                  "collision time {:.4g} s (variable hard spheres)",
                  plan.mach, plan.speed_ratio, plan.knudsen, plan.reynolds, c.reference.length, plan.mean_free_path,
                  plan.collision_time));
  const auto at_start =
      plan.particles_at_start > 0 ? fmt::format(", at the start about {:.0f}", plan.particles_at_start) : std::string();
  lines.push_back(
      fmt::format("time step {:g} s{}, weight {:g} molecules a particle; full of the free stream's gas about {:.0f} "
                  "particles ({:.1f} a cell){}; {:.0f} MB, {:.3g} steps, {:.3g} CPU s",
                  setup.dt, setup.cell_dt.empty() ? "" : " at most, varying with the cells", setup.fnum, plan.particles,
                  plan.particles_per_cell, at_start, plan.bytes * 1e-6, plan.steps, plan.cpu_seconds));
  if (plan.body) {
    const auto lift = [&](const Coefficients& k) {
      return plan.gives_lift ? fmt::format(" C_L {:.4f} C_m {:.4f}", k.lift, k.moment) : std::string();
    };
    const auto shown = [&](const Coefficients& k) { return fmt::format("C_D {:.4f}{}", k.drag, lift(k)); };
    const auto& free_molecular = plan.body->free_molecular;
    lines.push_back(fmt::format(
        "the body if it is convex and alone in the free stream: free-molecular {}; Newtonian {}",
        free_molecular
            ? fmt::format("{} C_H {:.4f}", shown(*free_molecular), free_molecular->heat)
            : fmt::format("flow not known, since the wall {} moves out of its plane", plan.body->moving_wall),
        shown(plan.body->newtonian)));
  }
  return lines;
}

nlohmann::json to_json(const Plan& plan) {
  const auto coefficients = [&](const Coefficients& k) {
    nlohmann::json j{{"C_D", k.drag}, {"C_H", k.heat}};
    if (plan.gives_lift) {
      j["C_L"] = k.lift;
      j["C_m"] = k.moment;
    }
    return j;
  };
  nlohmann::json report{{"mach", plan.mach},
                        {"speed_ratio", plan.speed_ratio},
                        {"knudsen", plan.knudsen},
                        {"reynolds", plan.reynolds},
                        {"lambda_inf", plan.mean_free_path},
                        {"tau_c", plan.collision_time},
                        {"particles", plan.particles},
                        {"particles_per_cell", plan.particles_per_cell},
                        {"particles_at_start", plan.particles_at_start},
                        {"bytes", plan.bytes},
                        {"steps", plan.steps},
                        {"cpu_seconds", plan.cpu_seconds},
                        {"cells_per_step", plan.longest_flight}};
  if (plan.body) {
    if (plan.body->free_molecular) report["free_molecular"] = coefficients(*plan.body->free_molecular);
    report["newtonian"] = coefficients(plan.body->newtonian);
  }
  return report;
}

}  // namespace pamr::dsmc
