// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "pamr/base/index.hpp"
#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::validate {

/// In order of report.
enum class Invariant : std::uint8_t {
  ids_in_range,
  cells_ascend,
  unique_cells,
  distinct_corners,
  fields_sized,
  finite_coordinates,
  orientation_positive,
  not_flat,
  patches_in_range,
  inner_patches_agree,
  untagged_outside,
  neighbors_reciprocal,
  conforming,
  border_matches,
  families_whole,
  unique_nodes,
  shared_nodes_equal,
  nodes_referenced,
  boundary_manifold,
};
inline constexpr std::array<const char*, 19> invariant_name{
    "ids_in_range",       "cells_ascend",         "unique_cells",     "distinct_corners", "fields_sized",
    "finite_coordinates", "orientation_positive", "not_flat",         "patches_in_range", "inner_patches_agree",
    "untagged_outside",   "neighbors_reciprocal", "conforming",       "border_matches",   "families_whole",
    "unique_nodes",       "shared_nodes_equal",   "nodes_referenced", "boundary_manifold"};

/// What this rank found: how often each invariant is broken, and the smallest place, `nowhere` where none is known.
struct Findings {
  static constexpr GlobalId nowhere = std::numeric_limits<GlobalId>::max();

  std::array<std::int64_t, invariant_name.size()> count{};
  std::array<GlobalId, invariant_name.size()> where{};

  Findings() { where.fill(nowhere); }
  void add(Invariant invariant, GlobalId place, std::int64_t times = 1) {
    const auto i = static_cast<std::size_t>(invariant);
    count[i] += times;
    where[i] = std::min(where[i], place);
  }
  bool has(Invariant invariant) const { return count[static_cast<std::size_t>(invariant)] != 0; }
};

inline LocalId slot_at(const mesh::DistMesh& mesh, mesh::CellFace face) {
  return mesh.cell_to_cell[at(face.cell)][at(face.slot)];
}

inline GlobalId number_of(const mesh::DistMesh& mesh, LocalId cell) { return mesh.cell_global[at(cell)]; }

}  // namespace pamr::validate
