// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/state/run_state.hpp"

#include <fmt/format.h>

#include <iterator>
#include <nlohmann/json.hpp>

#include "pamr/base/error.hpp"
#include "solvers/dsmc/state/header_values.hpp"

namespace pamr::dsmc {

namespace {

using nlohmann::json;

json row_to_json(const HistoryRow& r) {
  return json::array({r.step, r.sampled, r.n_steps, r.particles, r.entered, r.left, r.wall_hits, r.collisions,
                      r.crossings, r.body.drag, r.body.lift, r.body.moment, r.body.heat, r.t_tr, r.t_rot});
}

HistoryRow row_from(const json& value, std::uint64_t steps_done) {
  const auto& j = array_of(value, "a row of the history", 15);
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
          number(14)};
}

json load_to_json(const Load& l) {
  return json::array({l.force.x, l.force.y, l.force.z, l.moment.x, l.moment.y, l.moment.z, l.heat});
}

Load load_from(const json& value) {
  const auto& j = array_of(value, "the load of a patch", 7);
  const auto number = [&](std::size_t i) { return number_of(j[i], fmt::format("number {} of a load", i)); };
  return {{number(0), number(1), number(2)}, {number(3), number(4), number(5)}, number(6)};
}

}  // namespace

json to_json(const RunState& s) {
  json history = json::array(), blocks = json::array();
  for (const auto& row : s.history) history.push_back(row_to_json(row));
  for (const auto& block : s.blocks) {
    json loads = json::array();
    for (const auto& load : block) loads.push_back(load_to_json(load));
    blocks.push_back(loads);
  }
  return {
      {"sampling", s.sampling},       {"sampling_since", s.sampling_since},
      {"block_steps", s.block_steps}, {"first_step", s.first_step},
      {"carried", s.transferred},     {"steady_reason", s.steady_reason},
      {"in_interval", s.in_interval}, {"interval", row_to_json(s.interval)},
      {"history", history},           {"blocks", blocks},
      {"abandoned", s.stuck},         {"clamped", s.clamped},
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
  s.interval = row_from(member(j, "interval"), extent.steps_done);
  std::uint64_t last = 0;
  for (const auto& row : array_of(member(j, "history"), "history")) {
    s.history.push_back(row_from(row, extent.steps_done));
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
  s.face.resize(extent.n_faces);
  return s;
}

}  // namespace pamr::dsmc
