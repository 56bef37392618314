// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/mark/apply_criteria.hpp"
#include "pamr/mark/indicator.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mark {

/// Size of the mesh after a refinement with the given marks; collective.
using Prediction = std::function<std::int64_t(std::span<const std::uint8_t> marks)>;

/// Marks as many of the wanted cells, the most wanted first and ties in the order of their centroids, as keep the
/// predicted number of cells within `max_cells`; none when even one is too many.
/// Collective: log2(wanted) predictions, less those of marks that make too many cells whatever the closure. Pre: a
/// prediction grows with its marks, and has eight cells of each cell or closure family with a mark.
std::vector<std::uint8_t> marks_within_budget(const par::Comm& comm, const mesh::DistMesh& mesh,
                                              std::span<const double> indicator, Exact<std::int64_t> max_cells,
                                              const Prediction& predicted_cells);

/// Size of the mesh after splitting the marked cells and coarsening those that may be coarsened (and are not marked);
/// collective.
using PredictionBothWays =
    std::function<std::int64_t(std::span<const std::uint8_t> marks, std::span<const std::uint8_t> may_go)>;

/// `choose_within_budget` is content with this part of the cells that are allowed.
inline constexpr double smallest_part_of_budget = 0.98;

/// How many cells a mesh may have after marking.
struct Budget {
  Exact<std::int64_t> max_cells;
  Exact<bool> fill = false;  ///< a request that has fewer is made looser
  PredictionBothWays predicted_cells;
  KnownErrors known{};  ///< the errors that `apply` of the request found, or none
};

/// What `choose_within_budget` chose.
struct Choice {
  std::vector<std::uint8_t> marks, may_go;
  double factor = 1;  ///< by which values were made stricter
};

/// Splits the worst cells and coarsens the best, so that the mesh has at most `max_cells` cells, and no fewer than 98 %
/// of them if the request would have more: all values of the request are made stricter by one factor (`scaled`), so
/// that the hysteresis between splitting and coarsening is kept.
///
/// Fewer cells result if one level of splitting does not give as many, more if one level of coarsening does not take as
/// many; then nothing is marked. `applied`: `apply` of the request itself. Collective: about 30 predictions, less those
/// of marks that make too many cells whatever the closure. Pre: some criterion has a value.
Choice choose_within_budget(const par::Comm& comm, const mesh::DistMesh& mesh, const Request& request,
                            const Applied& applied, Budget budget);

}  // namespace pamr::mark
