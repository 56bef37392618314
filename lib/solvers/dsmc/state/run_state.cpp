// SPDX-License-Identifier: GPL-3.0-or-later
#include "solvers/dsmc/state/run_state.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>

#include "pamr/base/error.hpp"

namespace pamr::dsmc {

namespace {

using nlohmann::json;

json row_to_json(const HistoryRow& r) {
  return json::array({r.step, r.sampled, r.n_steps, r.particles, r.entered, r.left, r.wall_hits, r.collisions,
                      r.crossings, r.body.drag, r.body.lift, r.body.moment, r.body.heat, r.t_tr, r.t_rot});
}

HistoryRow row_from(const json& j) {
  return {j.at(0),  j.at(1), j.at(2), j.at(3), j.at(4),
          j.at(5),  j.at(6), j.at(7), j.at(8), {j.at(9), j.at(10), j.at(11), j.at(12)},
          j.at(13), j.at(14)};
}

json load_to_json(const Load& l) {
  return json::array({l.force.x, l.force.y, l.force.z, l.moment.x, l.moment.y, l.moment.z, l.heat});
}

Load load_from(const json& j) { return {{j.at(0), j.at(1), j.at(2)}, {j.at(3), j.at(4), j.at(5)}, j.at(6)}; }

}  // namespace

json to_json(const RunState& s) {
  json history = json::array(), blocks = json::array();
  for (const auto& row : s.history) history.push_back(row_to_json(row));
  for (const auto& block : s.blocks) {
    json loads = json::array();
    for (const auto& load : block) loads.push_back(load_to_json(load));
    blocks.push_back(loads);
  }
  return {{"sampling", s.sampling},
          {"sampling_since", s.sampling_since},
          {"first_step", s.first_step},
          {"carried", s.transferred},
          {"steady_reason", s.steady_reason},
          {"in_interval", s.in_interval},
          {"interval", row_to_json(s.interval)},
          {"history", history},
          {"blocks", blocks},
          {"abandoned", s.stuck},
          {"clamped", s.clamped}};
}

RunState run_state_from(const json& j, std::size_t n_faces) {
  try {
    RunState s;
    s.sampling = j.at("sampling");
    s.sampling_since = j.at("sampling_since");
    s.first_step = j.at("first_step");
    s.transferred = j.at("carried");
    s.steady_reason = j.at("steady_reason");
    s.in_interval = j.at("in_interval");
    s.interval = row_from(j.at("interval"));
    for (const auto& row : j.at("history")) s.history.push_back(row_from(row));
    for (const auto& block : j.at("blocks")) {
      s.blocks.emplace_back();
      for (const auto& load : block) s.blocks.back().push_back(load_from(load));
    }
    s.stuck = j.at("abandoned");
    s.clamped = j.at("clamped");
    s.face.resize(n_faces);
    return s;
  } catch (const json::exception& wrong) {
    throw Error(fmt::format("checkpoint: expected the state of a run, found other data: {}", wrong.what()));
  }
}

}  // namespace pamr::dsmc
