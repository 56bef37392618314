// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>

#include "pamr/base/exact.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::balance {

/// How good a distribution of cells over parts is. The same on every rank.
struct Quality {
  double imbalance = 1;       ///< greatest weight of a part / mean
  std::int64_t edge_cut = 0;  ///< faces between cells of different parts
  double compact_cut = 0;     ///< faces that compact parts of as many cells would have (`faces_between_compact_parts`)
  std::int64_t max_neighbors = 0;  ///< parts that share a face with one part: the most
  double mean_neighbors = 0;       ///< mean of the same
  std::int64_t empty_parts = 0;    ///< parts without cells
};

/// Faces between compact parts of so many cells each that together make a compact body of n cells:
/// `1.7 (s - 1) (1 + 0.57 / s^3) n^(2/3)` with `s` the sum of `(n_p / n)^(2/3)`, which is the cube root of the number of
/// equal parts. Scotch's parts have 0.5 to 1.5 times as many (docs/reports/balance.md). Local.
double faces_between_compact_parts(std::span<const std::int64_t> cells_of_part);

/// Looks at `part` (0 .. n_parts-1), the part of each of this rank's cells. Collective: one neighbor exchange, one
/// sparse exchange of 8 bytes a pair of adjacent parts that a rank sees, a reduction of 2 n_parts integers and three more.
Quality measure(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight,
                std::span<const Rank> part, Exact<Rank> n_parts);

/// The same for the distribution over the ranks that the mesh has, part by rank; faster: from the rank borders alone.
/// `weight_here`: of this rank's cells together. Collective: two gathers of a number a rank and three reductions.
Quality measure_ranks(const par::Comm& comm, const mesh::DistMesh& mesh, Exact<std::int64_t> weight_here);

/// All of it but the neighbors, which stay 0: faster. Collective: one neighbor exchange and two reductions.
Quality measure_cut(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const std::int64_t> weight,
                    std::span<const Rank> part, Exact<Rank> n_parts);

/// Greatest weight of a part over their mean. `part_weight`: one for each part. Local.
double imbalance_of(std::span<const std::int64_t> part_weight);

}  // namespace pamr::balance
