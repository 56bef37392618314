// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/flux_report.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>

#include "pamr/base/index.hpp"

namespace pamr::dsmc {

namespace {

using nlohmann::json;

json shown(const SurfaceFlux::Estimates& flux, KnownAverages known) {
  const auto values = [&](auto part, std::size_t first, std::size_t n) {
    if (n == 1) return json(part(flux[first]));
    json list = json::array();
    for (std::size_t k = first; k < first + n; ++k) list.push_back(part(flux[k]));
    return list;
  };
  json j;
  const auto add = [&](const char* key, std::size_t first, std::size_t n) {
    j[key]["value"] = values([&](const Estimate& e) { return known.is_any ? json(e.value) : json(); }, first, n);
    if (std::isfinite(known.student))
      j[key]["ci95"] = values([&](const Estimate& e) { return json(known.student * e.error); }, first, n);
  };
  add("molecules", 0, 1);
  add("momentum", 1, 3);
  add("energy", 4, 1);
  return j;
}

json shown(const SurfaceFlux& flux, KnownAverages known, bool is_plane) {
  return {{is_plane ? "along" : "out", shown(flux.out, known)},
          {is_plane ? "against" : "in", shown(flux.in, known)},
          {"net", shown(flux.net, known)}};
}

double pressure_of(const EnteringGas& entering) { return entering.gas.density * boltzmann * entering.gas.temperature; }

std::size_t n_patches_of(const Computation& computation) { return computation.flow().setup().patch.size(); }

}  // namespace

std::vector<std::string> surfaces_of(const Computation& computation) {
  std::vector<std::string> names;
  for (const auto& patch : computation.flow().setup().patches_on(computation.mesh())) names.push_back(patch.name);
  for (const auto& plane : computation.flow().setup().plane) names.push_back(plane.name);
  return names;
}

json fluxes_report(const Computation& computation) {
  const auto& averaging = computation.averaging();
  const auto& species = computation.flow().setup().gas.species;
  const auto names = surfaces_of(computation);
  const KnownAverages known{!averaging.state().flux_blocks.empty(), student_95(averaging.flux_groups().n_groups)};
  json report{{"blocks", averaging.state().flux_blocks.size()}, {"patches", json::object()}};
  for (std::size_t k = 0; k < names.size(); ++k) {
    const bool is_plane = k >= n_patches_of(computation);
    auto& entry = report[is_plane ? "planes" : "patches"][names[k]];
    entry = shown(averaging.flux(k, -1, species.size()), known, is_plane);
    for (std::size_t s = 0; s < species.size() && species.size() > 1; ++s)
      entry["species"][species[s].name] =
          shown(averaging.flux(k, static_cast<int>(s), species.size()), known, is_plane);
  }
  for (const auto& one : computation.flow().driven()) {
    const auto& e = one.entering();
    report["patches"][names[at(one.patch())]]["entering"] = {{"speed", e.speed},
                                                             {"temperature", e.gas.temperature},
                                                             {"pressure", pressure_of(e)},
                                                             {"limited", e.is_limited}};
  }
  return report;
}

std::vector<std::string> driven_warnings(const Computation& computation) {
  std::vector<std::string> warnings;
  for (const auto& one : computation.flow().driven()) {
    const auto& e = one.entering();
    const auto& name = computation.mesh().info.patches[at(one.patch())].name;
    if (e.is_limited)
      warnings.push_back(
          fmt::format("patch {}: gas would enter faster than sound and is held at {:.4g} m/s, so that it has another "
                      "pressure than asked for: use inflow from a stream, at rest for the gas of a vessel",
                      name, e.speed));
    if (-e.speed > one.sound())
      warnings.push_back(
          fmt::format("patch {}: gas leaves faster than sound, at {:.4g} m/s, so that the pressure "
                      "asked for has no effect: use outflow",
                      name, -e.speed));
  }
  return warnings;
}

std::vector<std::string> flux_lines(const Computation& computation) {
  const auto& averaging = computation.averaging();
  std::vector<std::string> lines;
  if (averaging.state().flux_blocks.empty()) return lines;
  const auto names = surfaces_of(computation);
  const auto& species = computation.flow().setup().gas.species;
  const double student = student_95(averaging.flux_groups().n_groups);
  const auto bound = [&](double error) {
    return std::isfinite(student) ? fmt::format(" +- {:.2g}", student * error) : std::string();
  };
  for (std::size_t k = 0; k < names.size(); ++k) {
    const bool is_plane = k >= n_patches_of(computation);
    const auto f = averaging.flux(k, -1, species.size());
    const double error = std::max({f.net[1].error, f.net[2].error, f.net[3].error});
    const auto molecules = [&](const SurfaceFlux& flux) {
      return fmt::format("{:.4g} {}, {:.4g} {}, net {:.4g}{} molecules/s", flux.out[0].value,
                         is_plane ? "along" : "out", flux.in[0].value, is_plane ? "against" : "in", flux.net[0].value,
                         bound(flux.net[0].error));
    };
    lines.push_back(fmt::format("{} {}: {}; net ({:.4g}, {:.4g}, {:.4g}){} N, {:.4g}{} W", is_plane ? "plane" : "patch",
                                names[k], molecules(f), f.net[1].value, f.net[2].value, f.net[3].value, bound(error),
                                f.net[4].value, bound(f.net[4].error)));
    if (species.size() < 2 || !(is_plane || computation.flow().setup().patch[k].is_open())) continue;
    for (std::size_t s = 0; s < species.size(); ++s)
      lines.push_back(
          fmt::format("  {}: {}", species[s].name, molecules(averaging.flux(k, static_cast<int>(s), species.size()))));
  }
  for (const auto& one : computation.flow().driven()) {
    const auto& e = one.entering();
    lines.push_back(fmt::format("patch {}: gas enters at {:.4g} Pa, {:.4g} K and {:.4g} m/s", names[at(one.patch())],
                                pressure_of(e), e.gas.temperature, e.speed));
  }
  return lines;
}

json balance_report(const GasBalance& b) {
  const auto part = [](double off) {
    return json{{"off", off}, {"allowed", GasBalance::allowed}, {"holds", off <= GasBalance::allowed}};
  };
  return {{"intervals", b.n_intervals},
          {"holds", b.holds()},
          {"particles",
           {{"before", b.before},
            {"in", b.in},
            {"out", b.out},
            {"after", b.after},
            {"unexplained", b.unexplained},
            {"holds", b.unexplained == 0}}},
          {"momentum", part(b.momentum)},
          {"energy", part(b.energy)}};
}

std::string balance_line(const GasBalance& b) {
  const auto part = [](const char* name, double off) {
    return fmt::format("{} off by {:.1e} ({})", name, off,
                       off <= GasBalance::allowed ? "rounding" : fmt::format("allowed {:.1e}", GasBalance::allowed));
  };
  return fmt::format("balance: {} particles in, {} out, {}; {}, {}", b.in, b.out,
                     b.unexplained == 0 ? std::string("exact") : fmt::format("{} UNEXPLAINED", b.unexplained),
                     part("momentum", b.momentum), part("energy", b.energy));
}

}  // namespace pamr::dsmc
