// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/adapt/depth.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/refine/split_pattern.hpp"

namespace pamr::adapt {

namespace {

constexpr GlobalId none = std::numeric_limits<GlobalId>::max();

/// Levels that the deepest cells made from this family lie below its base cell.
int levels_below(const refine::RebuiltFamily& family) {
  if (!refine::is_regular_split(family.state)) return 0;
  const bool again = std::any_of(family.child_state.begin(), family.child_state.end(), refine::is_regular_split);
  return again ? 2 : 1;
}

/// Calls `visit(cell)` for each cell of that level or a deeper one that would be split into eight; of a family for the
/// first member.
template <class Visit>
void for_each_split_from_level(const mesh::DistMesh& mesh, const refine::Closure& closure, int level, Visit&& visit) {
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    if (mesh.lineage[at(c)].level() >= level && closure.action[at(c)] == refine::Action::split &&
        closure.marks[at(c)] == refine::all_edges)
      visit(c);
  for (const auto& family : closure.rebuilt)
    if (mesh.lineage[at(family.first)].level() + levels_below(family) > level) visit(family.first);
}

/// The number of the first cell of the deepest level that would be split into eight.
GlobalId first_too_deep(const mesh::DistMesh& mesh, const refine::Closure& closure) {
  GlobalId first = none;
  for_each_split_from_level(mesh, closure, mesh::max_level,
                            [&](LocalId cell) { first = std::min(first, mesh.cell_global[at(cell)]); });
  return first;
}

}  // namespace

DepthLimited limit_depth(const mesh::DistMesh& mesh, std::span<const std::uint8_t> flags) {
  DepthLimited limited{{flags.begin(), flags.end()}, 0};
  for (std::size_t c = 0; c < limited.flags.size(); ++c) {
    if (limited.flags[c] == 0 || mesh.lineage[c].level() < mesh::max_level) continue;
    limited.flags[c] = 0;
    ++limited.n_left_out;
  }
  return limited;
}

std::string too_deep_text(std::int64_t n) {
  return fmt::format("{} marked cell{} left out: level {} is the deepest there is", n, n == 1 ? " was" : "s were",
                     mesh::max_level);
}

bool is_too_deep(const mesh::DistMesh& mesh, const refine::Closure& closure) {
  return first_too_deep(mesh, closure) != none;
}

std::int64_t count_splits_from_level(const mesh::DistMesh& mesh, const refine::Closure& closure, Exact<int> level) {
  std::int64_t n = 0;
  for_each_split_from_level(mesh, closure, level, [&n](LocalId) { ++n; });
  return n;
}

void require_depth(const par::Comm& comm, const mesh::DistMesh& mesh, const refine::Closure& closure) {
  const auto first = comm.min(first_too_deep(mesh, closure));
  if (first != none)
    throw Error(
        fmt::format("expected cells that can be split at the marked ones, found cell {} of level {}, the deepest there "
                    "is, beside them: mark no cells at it",
                    first, mesh::max_level));
}

}  // namespace pamr::adapt
