// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "pamr/mark/indicator.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mark {

/// Size of the mesh after a refinement with the given marks; collective.
using Prediction = std::function<std::int64_t(std::span<const std::uint8_t> marks)>;

/// Marks as many of the wanted cells, the most wanted first and ties in the order of their centroids, as keep the
/// predicted number of cells within `max_cells`; none when even one is too many.
/// Collective: log2(wanted) predictions. Pre: a prediction grows with its marks.
std::vector<std::uint8_t> marks_within_budget(const par::Comm& comm, const mesh::DistMesh& mesh,
                                              std::span<const double> indicator, std::int64_t max_cells,
                                              const Prediction& predicted_cells);

}  // namespace pamr::mark
