// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/floor_cost.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/curved/level0_shapes.hpp"
#include "pamr/mesh/level0_map.hpp"
#include "pamr/refine/close.hpp"
#include "pamr/refine/requests.hpp"
#include "pamr/refine/split_pattern.hpp"

namespace pamr::adapt {

namespace {

constexpr double near_floor =
    1.3;  ///< times the floor: where splitting into eight gives no more, the floor asks for cells
constexpr double min_share = 0.025;  ///< of the cells, those in octets that nobody asked for

/// About how many cells a cell with these marks becomes: more or less one for other cuts of its faces.
std::array<std::uint8_t, 64> make_children_of_marks() {
  std::array<std::uint8_t, 64> children{};
  children[0] = 1;
  children[refine::all_edges] = refine::max_children;
  for (std::size_t marks = 1; marks < refine::all_edges; ++marks)
    for (const auto& choice : refine::states_of_marks[marks])
      children[marks] =
          std::max(children[marks], static_cast<std::uint8_t>(refine::split_pattern[choice.state[0]].n_children));
  return children;
}

/// Cells of this rank that a closure gives.
std::int64_t cells_of(const refine::Closure& closure) {
  static const auto children = make_children_of_marks();
  std::int64_t n = 0;
  for (std::size_t c = 0; c < closure.marks.size(); ++c)
    if (closure.action[c] == refine::Action::split) n += children[closure.marks[c]];
  for (const auto& family : closure.rebuilt) n += family.n_children;
  return n;
}

/// Whether the floor may matter where a cell of the map was split.
std::vector<std::uint8_t> rows_near_floor(const mesh::Level0Map& map, double floor) {
  std::vector<std::uint8_t> is_near;
  for (std::size_t row = 0; row < map.cells().size(); ++row)
    is_near.push_back(curved::smallest_child(map, static_cast<LocalId>(row)) < near_floor * floor ? 1 : 0);
  return is_near;
}

/// Base cells of this rank that become eight near coarse walls although nobody asked for it, as far as the floor may
/// matter there.
std::int64_t count_added(const Closed& closed, double floor) {
  const auto& mesh = closed.mesh.get();
  const auto& closure = closed.closure;
  const mesh::Level0View level0(mesh);
  const auto is_near = rows_near_floor(*mesh.info.level0, floor);
  const auto matters = [&](LocalId c) {
    const auto row = level0.row_of(c);
    return row >= 0 && is_near[at(row)] != 0;
  };
  const auto is_asked = [&](LocalId c) { return refine::asks_for(closed.requests[at(c)], refine::Request::split); };
  std::int64_t n = 0;
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    if (closure.action[at(c)] == refine::Action::split && closure.marks[at(c)] == refine::all_edges && !is_asked(c))
      n += matters(c) ? 1 : 0;
  for (const auto& family : closure.rebuilt) {
    if (!refine::is_regular_split(family.state) || !matters(family.first)) continue;
    bool any_asked = false;
    for (int i = 0; i < mesh.lineage[at(family.first)].family_size(); ++i)
      any_asked = any_asked || is_asked(family.first + i);
    n += any_asked ? 0 : 1;
  }
  return n;
}

}  // namespace

double lower_floor(const mesh::DistMesh& mesh) { return mesh::has_level0(mesh) ? 0.3 : 0; }

std::optional<std::int64_t> cells_with_lower_floor(const par::Comm& comm, const Closed& closed,
                                                   const refine::Options& options) {
  if (options.quality_control != refine::QualityControl::removable ||
      options.shape_floor != refine::default_shape_floor)
    return {};
  const auto& mesh = closed.mesh.get();
  if (mesh::has_level0(mesh) && !closed.closure.has_early) {
    std::array<std::int64_t, 2> counts{cells_of(closed.closure), count_added(closed, options.shape_floor)};
    comm.sum_in_place(counts);
    const auto [cells, added] = counts;
    if (refine::max_children * static_cast<double>(added) < min_share * static_cast<double>(cells)) return {};
  }
  auto lower = options;
  lower.shape_floor = lower_floor(mesh);
  return comm.sum(cells_of(refine::close(comm, mesh, closed.borders, {closed.requests}, lower)));
}

double floor_cost(const par::Comm& comm, const Closed& closed, std::int64_t cells_with_lower) {
  const auto cells = static_cast<double>(comm.sum(cells_of(closed.closure)));
  return std::max(0.0, cells / static_cast<double>(cells_with_lower) - 1);
}

}  // namespace pamr::adapt
