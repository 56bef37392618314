// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/state/run_state.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <iterator>
#include <nlohmann/json.hpp>

#include "pamr/base/error.hpp"
#include "solvers/dsmc/state/header_values.hpp"

namespace pamr::dsmc {

namespace {

using nlohmann::json;

constexpr std::array all_begun{Begun::not_yet, Begun::by_case, Begun::steady, Begun::most_transient};

/// Of an older version from the reason, which it wrote in words only.
Begun begun_of(const std::string& reason, bool sampling) {
  if (!sampling) return Begun::not_yet;
  if (reason.starts_with("not steady")) return Begun::most_transient;
  return reason.ends_with("as the case says") ? Begun::by_case : Begun::steady;
}

Begun begun_from(const json& value) {
  const auto word = string_of(value, "begun");
  for (const auto begun : all_begun)
    if (word == word_for(begun)) return begun;
  throw Error(fmt::format("checkpoint: expected a word for why averages began, found \"{}\"", short_text(value)));
}

constexpr std::size_t history_numbers = 15;  ///< of a row, then those of the surfaces and of vibration

json row_to_json(const HistoryRow& r) {
  auto row = json::array({r.step, r.sampled, r.n_steps, r.particles, r.entered, r.left, r.wall_hits, r.collisions,
                          r.crossings, r.body.drag, r.body.lift, r.body.moment, r.body.heat, r.t_tr, r.t_rot});
  for (const auto& flux : r.fluxes)
    for (const double number : flux) row.push_back(number);
  for (const auto& ways : r.species)
    for (const double number : ways) row.push_back(number);
  if (r.t_vib) row.push_back(*r.t_vib);
  return row;
}

std::vector<NetFlux> fluxes_from(const json& row, std::size_t n_surfaces) {
  std::vector<NetFlux> fluxes(n_surfaces);
  auto next = history_numbers;
  for (auto& flux : fluxes)
    for (auto& number : flux) number = number_of(row[next++], "a flux of the history");
  return fluxes;
}

std::vector<std::array<double, 2>> species_from(const json& row, const RunExtent& extent) {
  std::vector<std::array<double, 2>> species(extent.n_surfaces * extent.n_species);
  auto next = history_numbers + NetFlux{}.size() * extent.n_surfaces;
  for (auto& ways : species)
    for (auto& number : ways) number = number_of(row[next++], "molecules of a species in the history");
  return species;
}

HistoryRow row_from(const json& value, const RunExtent& extent) {
  const auto steps_done = extent.steps_done;
  const auto n_fluxes = NetFlux{}.size() * extent.n_surfaces;
  const auto n_of_species = extent.n_species < 2 ? 0 : 2 * extent.n_surfaces * extent.n_species;
  const auto size = value.is_array() ? value.size() : 0;
  // older versions have written rows without the species, and before without any fluxes
  const std::array<std::size_t, 3> known{history_numbers + n_fluxes + n_of_species, history_numbers + n_fluxes,
                                         history_numbers};
  const bool vibrates = std::find(known.begin(), known.end(), size - 1) != known.end();
  const auto numbers = size - (vibrates ? 1 : 0);
  const bool is_old = numbers == known[2], has_species = n_of_species > 0 && numbers == known[0];
  const bool is_known = std::find(known.begin(), known.end(), numbers) != known.end();
  const auto& j = array_of(value, "a row of the history", is_known ? size : known[0]);
  const auto count = [&](std::size_t i) { return count_of(j[i], fmt::format("number {} of the history", i)); };
  const auto number = [&](std::size_t i) { return number_of(j[i], fmt::format("number {} of the history", i)); };
  return {static_cast<std::uint64_t>(count_of(j[0], "step of the history", static_cast<std::int64_t>(steps_done))),
          truth_of(j[1], "number 1 of the history"),
          count(2),
          count(3),
          count(4),
          count(5),
          count(6),
          count(7),
          count(8),
          {number(9), number(10), number(11), number(12)},
          number(13),
          number(14),
          is_old ? std::vector<NetFlux>{} : fluxes_from(j, extent.n_surfaces),
          vibrates ? std::optional(number(size - 1)) : std::nullopt,
          has_species ? species_from(j, extent) : std::vector<std::array<double, 2>>{}};
}

json load_to_json(const Load& l) {
  return json::array({l.force.x, l.force.y, l.force.z, l.moment.x, l.moment.y, l.moment.z, l.heat});
}

Load load_from(const json& value) {
  const auto& j = array_of(value, "the load of a patch", 7);
  const auto number = [&](std::size_t i) { return number_of(j[i], fmt::format("number {} of a load", i)); };
  return {{number(0), number(1), number(2)}, {number(3), number(4), number(5)}, number(6)};
}

json to_json(const std::vector<std::vector<FluxRate>>& blocks) {
  json shown = json::array();
  for (const auto& block : blocks) {
    json numbers = json::array();
    for (const auto& rate : block)
      for (const double number : rate) numbers.push_back(number);
    shown.push_back(numbers);
  }
  return shown;
}

std::vector<std::vector<FluxRate>> flux_blocks_from(const json& value, const RunExtent& extent, std::size_t n_blocks) {
  const std::size_t n_rows = 2 * extent.n_surfaces * extent.n_species;
  std::vector<std::vector<FluxRate>> blocks;
  for (const auto& block : array_of(value, "flux_blocks")) {
    const auto& numbers = array_of(block, "a block of fluxes", FluxRate{}.size() * n_rows);
    auto& rates = blocks.emplace_back(n_rows);
    std::size_t next = 0;
    for (auto& rate : rates)
      for (auto& number : rate) number = number_of(numbers[next++], "a flux");
  }
  if (blocks.size() > n_blocks)
    throw Error(fmt::format("checkpoint: expected at most {} blocks of fluxes, found {}", n_blocks, blocks.size()));
  return blocks;
}

json to_json(const GasContents& c) {
  json sums = json::array();
  for (const auto& sum : {c.momentum[0], c.momentum[1], c.momentum[2], c.translation, c.rotation, c.deficit}) {
    sums.push_back(sum.low);
    sums.push_back(sum.high);
  }
  if (c.vibration)
    for (const auto word : {c.vibration->low, c.vibration->high}) sums.push_back(word);
  return {{"particles", c.n}, {"sums", sums}};
}

GasContents contents_from(const json& j, std::size_t n_species) {
  GasContents c;
  const auto& n = member(j, "particles");
  if (array_of(n, "particles").empty()) return c;
  for (const auto& one : array_of(n, "particles", n_species)) c.n.push_back(count_of(one, "particles"));
  constexpr std::size_t n_words = 12;
  const auto& value = member(j, "sums");
  const bool vibrates = value.is_array() && value.size() == n_words + 2;
  const auto& sums = array_of(value, "sums", n_words + (vibrates ? 2 : 0));
  std::size_t next = 0;
  for (auto* sum : {&c.momentum[0], &c.momentum[1], &c.momentum[2], &c.translation, &c.rotation, &c.deficit})
    for (auto* word : {&sum->low, &sum->high}) *word = integer_of(sums[next++], "a sum over the particles");
  if (vibrates)
    c.vibration =
        WideSum{integer_of(sums[next], "a sum of vibration"), integer_of(sums[next + 1], "a sum of vibration")};
  return c;
}

json to_json(const GasBalance& b) {
  return {
      {"intervals", b.n_intervals},   {"before", b.before},     {"in", b.in},        {"out", b.out}, {"after", b.after},
      {"unexplained", b.unexplained}, {"momentum", b.momentum}, {"energy", b.energy}};
}

GasBalance balance_from(const json& j) {
  const auto count = [&](const char* key) { return count_of(member(j, key), key); };
  return {count("intervals"),
          count("before"),
          count("in"),
          count("out"),
          count("after"),
          count("unexplained"),
          number_of(member(j, "momentum"), "momentum"),
          number_of(member(j, "energy"), "energy")};
}

}  // namespace

const char* word_for(Begun begun) {
  switch (begun) {
    case Begun::not_yet:
      return "not yet";
    case Begun::by_case:
      return "case";
    case Begun::steady:
      return "steady";
    case Begun::most_transient:
      return "most_transient";
  }
  return "";
}

json to_json(const RunState& s) {
  json history = json::array(), blocks = json::array();
  for (const auto& row : s.history) history.push_back(row_to_json(row));
  for (const auto& block : s.blocks) {
    json loads = json::array();
    for (const auto& load : block) loads.push_back(load_to_json(load));
    blocks.push_back(loads);
  }
  return {
      {"sampling", s.sampling},
      {"sampling_since", s.sampling_since},
      {"block_steps", s.block_steps},
      {"first_step", s.first_step},
      {"carried", s.transferred},
      {"steady_reason", s.steady_reason},
      {"in_interval", s.in_interval},
      {"interval", row_to_json(s.interval)},
      {"history", history},
      {"blocks", blocks},
      {"abandoned", s.stuck},
      {"clamped", s.clamped},
      {"flux_blocks", to_json(s.flux_blocks)},
      {"contents", to_json(s.contents)},
      {"balance", to_json(s.balance)},
      {"begun", word_for(s.begun)},
      {"restarts", s.n_restarts},
  };
}

RunState run_state_from(const json& j, const RunExtent& extent) {
  const auto steps_done = static_cast<std::int64_t>(extent.steps_done);
  const auto step = [&](const char* key) {
    return static_cast<std::uint64_t>(count_of(member(j, key), key, steps_done));
  };
  RunState s;
  s.sampling = truth_of(member(j, "sampling"), "sampling");
  s.sampling_since = step("sampling_since");
  s.block_steps = count_of(member(j, "block_steps"), "block_steps", std::int64_t{1} << 32U);
  s.first_step = step("first_step");
  s.transferred = truth_of(member(j, "carried"), "carried");
  s.steady_reason = string_of(member(j, "steady_reason"), "steady_reason");
  s.in_interval = count_of(member(j, "in_interval"), "in_interval", steps_done);
  s.interval = row_from(member(j, "interval"), extent);
  std::uint64_t last = 0;
  for (const auto& row : array_of(member(j, "history"), "history")) {
    s.history.push_back(row_from(row, extent));
    if (s.history.back().step < last || s.history.back().n_steps == 0)
      throw Error(
          fmt::format("checkpoint: expected a history of intervals one after another, found {} steps to step {}",
                      s.history.back().n_steps, s.history.back().step));
    last = s.history.back().step;
  }
  for (const auto& block : array_of(member(j, "blocks"), "blocks")) {
    s.blocks.emplace_back();
    for (const auto& load : array_of(block, "a block of loads", extent.n_patches))
      s.blocks.back().push_back(load_from(load));
  }
  const bool fit = s.sampling ? s.in_interval < s.block_steps && std::ssize(s.blocks) <= steps_done / s.block_steps
                              : s.blocks.empty();
  if (!fit)
    throw Error(fmt::format("checkpoint: expected {} after {} steps, found {} blocks of {} steps and {} more steps",
                            s.sampling ? "averages in blocks" : "no averages", steps_done, s.blocks.size(),
                            s.block_steps, s.in_interval));
  s.stuck = count_of(member(j, "abandoned"), "abandoned");
  s.clamped = count_of(member(j, "clamped"), "clamped");
  s.begun = j.contains("begun") ? begun_from(j["begun"]) : begun_of(s.steady_reason, s.sampling);
  if (j.contains("restarts")) s.n_restarts = count_of(j["restarts"], "restarts");
  // Older versions have not counted fluxes: those of the blocks and intervals that begin now are.
  if (j.contains("flux_blocks")) s.flux_blocks = flux_blocks_from(j["flux_blocks"], extent, s.blocks.size());
  if (j.contains("contents")) s.contents = contents_from(j["contents"], extent.n_species);
  if (j.contains("balance")) s.balance = balance_from(j["balance"]);
  s.face.resize(extent.n_faces);
  return s;
}

}  // namespace pamr::dsmc
