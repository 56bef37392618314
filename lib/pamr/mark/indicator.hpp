// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mark {

/// How much each cell of this rank wants to be split: 0 not at all, positive wanted, the larger the sooner. Criteria
/// without a degree (a cell is inside or it is not) give infinity.
using Indicator = std::vector<double>;

/// The value with its mantissa rounded to 20 bits, ties to even. Everything that comes from a solver is rounded so
/// before it is compared: the last bits of a solver's sums depend on the number of ranks, marks must not.
double round_to_20_bits(double value);

/// Cells wanted by either: the larger value of the two. Local.
void unite(Indicator& indicator, std::span<const double> other);

/// Centroid of a cell: the corners are added in the order of their coordinates, so that it does not depend on how they
/// are numbered.
geometry::Vec3 centroid(const mesh::DistMesh& mesh, Exact<LocalId> cell);

/// Takes the wish from cells whose base cell already has level `max_level` or more, so that no cell of the refined mesh
/// is finer than that by its own mark (closure counts the level of the cell it closes). Returns how many wishes of this
/// rank's cells it took. Local.
std::int64_t keep_below_level(const mesh::DistMesh& mesh, Exact<int> max_level, Indicator& indicator);

/// Marks (0 or 1) of all cells that are wanted. Local.
std::vector<std::uint8_t> marks_of(std::span<const double> indicator);

/// Marks of the `count` most wanted cells over all ranks, fewer when fewer are wanted; ties are broken by the
/// centroid's coordinates, the smaller first. Collective: at most 41 reductions.
std::vector<std::uint8_t> strongest(const par::Comm& comm, const mesh::DistMesh& mesh,
                                    std::span<const double> indicator, Exact<std::int64_t> count);

/// Number of marked cells over all ranks. Collective: one reduction.
std::int64_t count_marked(const par::Comm& comm, std::span<const std::uint8_t> marks);

/// Largest number of times that a cell can be made to wait before it is coarsened.
inline constexpr int max_keep_for = 250;

/// Keeps cells that may be coarsened until they were marked so more than `n_times` in a row. How often that was so is
/// counted in the cell field `NAME_idle` of the mesh, which refining and coarsening hand on; it is made or replaced.
/// Throws `Error` on every rank where the mesh has other data under that name. Collective.
void keep_for_a_while(const par::Comm& comm, mesh::DistMesh& mesh, const std::string& name, Exact<int> n_times,
                      std::span<std::uint8_t> may_go);

/// The same for a trial: the mesh stays as it is. Returns the counts. Collective.
std::vector<std::int64_t> keep_in_trial(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& name,
                                        Exact<int> n_times, std::span<std::uint8_t> may_go);

/// Puts marks into the mesh as integer cell field `name` (0 keep, 1 split), in place of any field of that name. Those
/// of cells without a mark that `may_go` (n_cells, 0 or 1, or empty: none) are -1. Local.
void set_marks(mesh::DistMesh& mesh, std::span<const std::uint8_t> marks, const std::string& name = "refine",
               std::span<const std::uint8_t> may_go = {});

}  // namespace pamr::mark
