// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

/// The parts of `validate`. Private to the library.
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
  neighbors_reciprocal,
  conforming,
  border_matches,
  families_whole,
  unique_nodes,
  shared_nodes_equal,
  nodes_referenced,
  boundary_manifold,
};
inline constexpr std::array<const char*, 17> invariant_name{
    "ids_in_range",       "cells_ascend",         "unique_cells",   "distinct_corners", "fields_sized",
    "finite_coordinates", "orientation_positive", "not_flat",       "patches_in_range", "neighbors_reciprocal",
    "conforming",         "border_matches",       "families_whole", "unique_nodes",     "shared_nodes_equal",
    "nodes_referenced",   "boundary_manifold"};

/// What this rank found: how often each invariant is broken, and the smallest place.
struct Findings {
  std::array<std::int64_t, invariant_name.size()> count{};
  std::array<GlobalId, invariant_name.size()> where{};

  Findings() { where.fill(std::numeric_limits<GlobalId>::max()); }
  void add(Invariant invariant, GlobalId at, std::int64_t times = 1) {
    const auto i = static_cast<std::size_t>(invariant);
    count[i] += times;
    where[i] = std::min(where[i], at);
  }
  bool has(Invariant invariant) const { return count[static_cast<std::size_t>(invariant)] != 0; }
};

inline LocalId slot_at(const mesh::DistMesh& mesh, mesh::CellFace face) {
  return mesh.cell_to_cell[static_cast<std::size_t>(face.cell)][static_cast<std::size_t>(face.slot)];
}

inline GlobalId number_of(const mesh::DistMesh& mesh, LocalId cell) {
  return mesh.cell_global[static_cast<std::size_t>(cell)];
}

/// Lengths, numbers in range, distinct corners, ascending cells, fields: what the rest relies on. Local.
void check_structure(const mesh::DistMesh& mesh, Rank rank, Rank size, Findings& findings);

/// Every global cell number once. Collective: one sparse exchange of the runs of numbers.
void check_unique_cells(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings);

/// Coordinates, orientation, shape. Local.
void check_shapes(const mesh::DistMesh& mesh, Findings& findings);

/// True when `check_own_neighbors` would find nothing: the same said without saying where it is broken, which is all
/// that a sound mesh asks for, three times faster. Local; 16 bytes a cell and 8 a node.
bool own_faces_match(const mesh::DistMesh& mesh);

/// Patches, own neighbors, own faces. Local.
void check_own_neighbors(const mesh::DistMesh& mesh, Findings& findings);

/// Closure families. Local.
void check_families(const mesh::DistMesh& mesh, Findings& findings);

/// Rank-border faces. Collective: one sparse exchange of 8 bytes a face, one more where something is wrong.
void check_border(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings);

/// Nodes, and faces all of whose nodes other ranks hold too; after `check_border`, on whose findings it relies.
/// Collective: three sparse exchanges, two more where something is wrong.
void check_shared(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings);

/// Edges of the boundary. Collective: one sparse exchange.
void check_boundary(const par::Comm& comm, const mesh::DistMesh& mesh, Findings& findings);

/// -1 or 1: whether the face's nodes, in the order whose normal points out of the cell, are an odd or even permutation
/// of their ascending global numbers. Cells on the two sides of a face have opposite signs.
int face_sign(const mesh::DistMesh& mesh, mesh::CellFace face);

}  // namespace pamr::validate
