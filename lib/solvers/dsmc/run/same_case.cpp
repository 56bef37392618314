// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/run/same_case.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "pamr/base/error.hpp"
#include "pamr/base/hash.hpp"
#include "pamr/base/index.hpp"
#include "solvers/dsmc/sampling/loads.hpp"
#include "solvers/dsmc/state/header_values.hpp"

namespace pamr::dsmc {

namespace {

using nlohmann::json;

json facts_of(const Vec3& v) { return {v.x, v.y, v.z}; }

json facts_of(const Species& s) {
  json facts{{"mass", s.mass},   {"diameter", s.diameter}, {"omega", s.omega},
             {"t_ref", s.t_ref}, {"alpha", s.alpha},       {"rotational_degrees", s.rotational_degrees}};
  if (!s.vibration.mode.empty()) facts["vibration"] = facts_of(s.vibration);
  return facts;
}

json facts_of(const Rotation& r) {
  switch (r.model) {
    case Rotation::Model::probability:
      return {{"probability", r.value}};
    case Rotation::Model::z_continuum:
      return {{"z_continuum", r.value}};
    case Rotation::Model::variable:
      return {{"z_infinity", r.z_infinity}, {"t_star", r.t_star}};
  }
  return {};
}

json by_species(const Gas& gas, const std::vector<double>& values) {
  json facts = json::object();
  for (std::size_t s = 0; s < gas.species.size(); ++s) facts[gas.species[s].name] = values[s];
  return facts;
}

json facts_of(const Stream& s, const Gas& gas) {
  json facts{{"density", s.density},
             {"temperature", s.temperature},
             {"rotational_temperature", s.rotational_temperature},
             {"velocity", facts_of(s.velocity)},
             {"fractions", by_species(gas, s.fraction)}};
  if (gas.is_vibrating) facts["vibrational_temperature"] = s.vibrational_temperature;
  return facts;
}

std::string name_of(const std::vector<Stream>& streams, int stream) {
  return stream < 0 ? "vacuum" : streams[at(stream)].name;
}

json facts_of(const BoundaryCondition& b, const Setup& setup, const std::vector<mesh::Patch>& patches) {
  using Kind = BoundaryCondition::Kind;
  switch (b.kind) {
    case Kind::specular:
      return {{"kind", "specular"}};
    case Kind::symmetry:
      return {{"kind", "symmetry"}};
    case Kind::outflow:
      return {{"kind", "outflow"}};
    case Kind::inlet:
      return {{"kind", "inlet"},
              {"stream", name_of(setup.stream, b.stream)},
              {"mass_flow", b.mass_flow},
              {"relaxation", b.relaxation}};
    case Kind::outlet:
      return {{"kind", "outlet"}, {"pressure", b.pressure}, {"relaxation", b.relaxation}};
    case Kind::inflow:
      return {{"kind", "inflow"}, {"stream", name_of(setup.stream, b.stream)}};
    case Kind::periodic:
      return {{"kind", "periodic"}, {"partner", patches[at(b.partner)].name}};
    case Kind::diffuse:
      return {{"kind", "diffuse"},
              {"temperature", b.temperature},
              {"velocity", facts_of(b.velocity)},
              {"accommodation", b.accommodation}};
    case Kind::cll: {
      json facts{{"kind", "cll"},
                 {"temperature", b.temperature},
                 {"velocity", facts_of(b.velocity)},
                 {"normal_accommodation", b.normal_accommodation},
                 {"tangential_accommodation", b.tangential_accommodation},
                 {"rotational_accommodation", b.rotational_accommodation}};
      if (setup.gas.is_vibrating) facts["vibrational_accommodation"] = b.vibrational_accommodation;
      return facts;
    }
  }
  return {};
}

json facts_of_start(const Setup& setup) {
  json regions = json::array();
  for (const auto& r : setup.region) {
    json region{{"stream", name_of(setup.stream, r.stream)}};
    if (r.radius > 0)
      region["sphere"] = {r.center.x, r.center.y, r.center.z, r.radius};
    else
      region["box"] = {r.low.x, r.low.y, r.low.z, r.high.x, r.high.y, r.high.z};
    regions.push_back(region);
  }
  return {{"stream", name_of(setup.stream, setup.initial)}, {"region", regions}};
}

json facts_of(const FluxPlane& p) {
  return {{"point", facts_of(p.point)},
          {"normal", facts_of(p.normal)},
          {"radius", p.radius},
          {"along", facts_of(p.along)},
          {"across", facts_of(p.across)}};
}

json facts_of(const CollisionOptions& collisions) {
  using Partner = CollisionOptions::Partner;
  const char* partner = collisions.partner == Partner::any       ? "any"
                        : collisions.partner == Partner::subcell ? "subcell"
                                                                 : "nearest";
  return {{"enabled", static_cast<bool>(collisions.enabled)}, {"partner", partner}};
}

/// The weight; in a run that adapts its mesh what it was computed from, for that mesh is gone.
json facts_of_particles(const Case& c, const Setup& setup) {
  json facts = json::object();
  if (c.adaptation.every == 0) facts["weight"] = setup.fnum;
  if (c.adaptation.every > 0 && c.weight) facts["weight"] = *c.weight;
  if (c.adaptation.every > 0 && c.total) facts["total"] = *c.total;
  if (c.adaptation.every > 0 && c.per_cell) facts["per_cell"] = *c.per_cell;
  for (const auto& s : c.gas.species) facts["species_weights"][s.name] = s.weight;
  return facts;
}

/// With a hash of the cells' time steps: with `from_fields` they follow from fields that no case names.
json facts_of_time(const par::Comm& comm, const Case& c, const Setup& setup, const mesh::DistMesh& mesh) {
  std::uint64_t hash = 0;
  for (std::size_t i = 0; i < setup.cell_dt.size(); ++i)
    hash += combine(static_cast<std::uint64_t>(mesh.cell_global[i] - mesh.info.first_id), bits_of(setup.cell_dt[i]));
  return {{"step", c.dt},
          {"cell_fraction", c.cell_fraction},
          {"collision_fraction", c.collision_fraction},
          {"from_fields", c.from_fields},
          {"steps of the cells (a hash)", static_cast<std::uint64_t>(comm.sum(static_cast<std::int64_t>(hash)))}};
}

json facts_of(const Case& c, const Schedule& s) {
  return {
      {"seed", c.seed}, {"window", s.window}, {"transient", s.transient ? json(*s.transient) : json("until steady")}};
}

json facts_of(const Reference& r, const std::vector<mesh::Patch>& patches,
              const std::vector<BoundaryCondition>& conditions) {
  json names = json::array();
  const auto wanted = reference_patches(r, patches, conditions);
  for (std::size_t p = 0; p < patches.size(); ++p)
    if (wanted[p]) names.push_back(patches[p].name);
  return {{"area", r.area},
          {"length", r.length},
          {"point", facts_of(r.point)},
          {"pitch_axis", facts_of(r.pitch_axis)},
          {"multiplier", r.multiplier},
          {"patches", names}};
}

json facts_of(const Adaptation& a) {
  json facts = json::object();
  if (a.every == 0) return facts;
  facts["mark"] = a.mark;
  facts["every"] = a.every;
  if (a.max_cells) facts["max_cells"] = *a.max_cells;
  return facts;
}

/// Adds a line for each value that differs, the value of an object by the name of its member.
void add_differences(const json& before, const json& now, const std::string& name, std::vector<std::string>& lines) {
  const auto inner = [&](const std::string& key) { return name.empty() ? key : fmt::format("{}.{}", name, key); };
  if (before.is_object() && now.is_object()) {
    for (const auto& [key, value] : before.items())
      add_differences(value, now.contains(key) ? now[key] : json(), inner(key), lines);
    for (const auto& [key, value] : now.items())
      if (!before.contains(key)) add_differences(json(), value, inner(key), lines);
  } else if (before != now) {
    const auto text = [](const json& value) { return value.is_null() ? "nothing" : short_text(value); };
    lines.push_back(fmt::format("{}: the checkpoint has {}, the case {}", name, text(before), text(now)));
  }
}

}  // namespace

json facts_of(const Vibration& v) {
  return {{"temperatures", v.mode}, {"c1", v.c1}, {"c2", v.c2}, {"cross_section", v.cross_section}};
}

json facts_of(const par::Comm& comm, const Case& c, const Setup& setup, const mesh::DistMesh& mesh) {
  const auto& patches = setup.patches_on(mesh);
  json facts{{"gas", {{"fractions", by_species(c.gas, c.gas.fraction)}, {"rotation", facts_of(c.gas.rotation)}}},
             {"initial", facts_of_start(setup)},
             {"collisions", facts_of(setup.collisions)},
             {"particles", facts_of_particles(c, setup)},
             {"time", facts_of_time(comm, c, setup, mesh)},
             {"run", facts_of(c, c.schedule)},
             {"reference", facts_of(c.reference, patches, setup.patch)},
             {"adapt", facts_of(c.adaptation)},
             {"domain", {{"unit", setup.unit}}}};
  for (const auto& s : c.gas.species) facts["species"][s.name] = facts_of(s);
  for (const auto& s : setup.stream) facts["stream"][s.name] = facts_of(s, c.gas);
  for (const auto& p : setup.plane) facts["plane"][p.name] = facts_of(p);
  for (std::size_t p = 0; p < patches.size(); ++p)
    facts["boundary"][patches[p].name] = facts_of(setup.patch[p], setup, patches);
  for (const auto& wall : setup.inner_wall) {
    const auto& [x, y, z] = wall.facing.value;
    facts["front"][patches[at(wall.side[0])].name] = {{wall.facing.from_point ? "inside" : "front", {x, y, z}}};
  }
  return facts;
}

void require_same_case(const json& header, const json& facts) {
  constexpr std::size_t max_shown = 8;
  constexpr const char* way_on = "--carry begins a new run with this flow";
  const auto found = header.find(facts_member);
  if (found == header.end())
    throw Error(
        fmt::format("expected the facts of the case that the checkpoint was written for, found none: an earlier "
                    "version has written it; {}",
                    way_on));
  std::vector<std::string> lines;
  add_differences(*found, facts, "", lines);
  if (lines.empty()) return;
  std::string shown;
  for (std::size_t i = 0; i < std::min(lines.size(), max_shown); ++i) shown += lines[i] + "; ";
  if (lines.size() > max_shown) shown += fmt::format("and {} more; ", lines.size() - max_shown);
  throw Error(fmt::format("expected a checkpoint of this case, found one of another: {}{}", shown, way_on));
}

}  // namespace pamr::dsmc
