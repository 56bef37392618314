// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/history.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>

#include "pamr/base/csv_field.hpp"

namespace pamr::dsmc {

namespace {

constexpr std::array<const char*, NetFlux{}.size()> quantities{":out_per_s", ":in_per_s", ":Fx", ":Fy", ":Fz", ":W"};

}  // namespace

std::string to_csv(const std::vector<HistoryRow>& history, double dt, const std::vector<std::string>& surfaces,
                   const std::vector<Species>& species) {
  std::string text =
      "step,time,averaged,particles,entered_per_step,left_per_step,wall_hits_per_step,collisions_per_particle_step,"
      "crossings_per_particle_step,C_D,C_L,C_m,C_H,T_tr,T_rot";
  const bool vibrates =
      std::any_of(history.begin(), history.end(), [](const auto& row) { return row.t_vib.has_value(); });
  if (vibrates) text += ",T_vib";
  for (const auto& surface : surfaces)
    for (const auto* quantity : quantities) text += "," + csv_field(surface + quantity);
  const std::size_t n_species = species.size() < 2 ? 0 : species.size();
  for (const auto& surface : surfaces)
    for (std::size_t s = 0; s < n_species; ++s)
      for (std::size_t way = 0; way < 2; ++way)
        text += "," + csv_field(surface + ":" + species[s].name + quantities[way]);
  text += "\n";
  for (const auto& row : history) {
    const double n = static_cast<double>(row.n_steps),
                 all = n * static_cast<double>(std::max<std::int64_t>(1, row.particles));
    text += fmt::format("{},{:.9g},{},{},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g},{:.9g}",
                        row.step, static_cast<double>(row.step) * dt, row.sampled ? 1 : 0, row.particles,
                        static_cast<double>(row.entered) / n, static_cast<double>(row.left) / n,
                        static_cast<double>(row.wall_hits) / n, static_cast<double>(row.collisions) / all,
                        static_cast<double>(row.crossings) / all, row.body.drag, row.body.lift, row.body.moment,
                        row.body.heat, row.t_tr, row.t_rot);
    if (vibrates) text += row.t_vib ? fmt::format(",{:.9g}", *row.t_vib) : ",";
    for (const auto& flux : row.fluxes)
      for (const double number : flux) text += fmt::format(",{:.9g}", number);
    if (row.fluxes.empty()) text.append(quantities.size() * surfaces.size(), ',');
    for (const auto& ways : row.species)
      for (const double number : ways) text += fmt::format(",{:.9g}", number);
    if (row.species.empty()) text.append(2 * surfaces.size() * n_species, ',');
    text += "\n";
  }
  return text;
}

std::string particles_and_drift(const std::vector<HistoryRow>& history) {
  if (history.empty()) return "";
  const double now = static_cast<double>(history.back().particles);
  auto text = fmt::format("{} particles", history.back().particles);
  if (history.size() <= 10) return text;
  const double then = static_cast<double>(history[history.size() - 11].particles);
  return text + fmt::format(", drift {:+.2f} %", 100 * (now - then) / std::max(1.0, then));
}

}  // namespace pamr::dsmc
