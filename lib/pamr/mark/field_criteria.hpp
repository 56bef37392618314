// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "pamr/base/exact.hpp"
#include "pamr/mark/indicator.hpp"

namespace pamr::mark {

/// Criteria that look at a field. The field has one component; a nodal field counts with the mean of the cell's four
/// corners; where cells and nodes have a field of the same name, the one on cells is taken. Values and thresholds are
/// rounded to 20 bits before they are compared. Every function throws `Error` on every rank when there is no such
/// field, it has several components, or a value is not finite (naming the cell).

/// The field on every cell of this rank, not rounded. Collective: one reduction.
std::vector<double> scalar_on_cells(const par::Comm& comm, const mesh::DistMesh& mesh, std::string_view field);

/// A side of a threshold.
enum class Side { above, below };
struct Threshold {
  std::string field;
  Side side = Side::above;
  double value = 0;
};

/// Cells whose value lies above (below) the threshold, not on it. Indicator: how far beyond the threshold, over its
/// size (over 1 when the threshold is 0). Collective.
Indicator beyond_threshold(const par::Comm& comm, const mesh::DistMesh& mesh, const Threshold& threshold);

/// Measure of a cell's size, length unit: cube root of its volume, or its longest edge.
enum class CellSize { cbrt_volume, longest_edge };
double cell_size(const mesh::DistMesh& mesh, Exact<LocalId> cell, CellSize measure);

/// Cells larger than `ratio` times a length given as field (mean free path, Debye length): size / length > ratio.
/// Indicator: by how much, over the ratio. Collective. Throws `Error` too when a length or the ratio is not positive.
Indicator larger_than_length(const par::Comm& comm, const mesh::DistMesh& mesh, std::string_view field, double ratio,
                             CellSize measure = CellSize::cbrt_volume);

/// How sure a value must be to count as beyond a threshold: by more than `times` the error that `field` gives for it.
struct Certainty {
  std::string field;  ///< standard error of the value, at least 0; empty: values count as they are
  double times = 3;
};
/// A threshold that only values count as beyond which are surely so.
struct Cutoff {
  Threshold threshold;
  Certainty certainty{};
};

/// Takes the wish from cells whose value does not lie beyond the threshold, or not surely. Collective. Throws `Error`
/// too when an error is negative.
void keep_only_where(const par::Comm& comm, const mesh::DistMesh& mesh, const Cutoff& cutoff, Indicator& indicator);

}  // namespace pamr::mark
