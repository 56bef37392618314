// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::balance {

/// Sum of integer weights up to which a partition is computed: far from the end of 64 bits whatever it is multiplied
/// by.
inline constexpr std::int64_t max_total_weight = std::int64_t{1} << 44U;

/// Integer weights in proportion to real ones, for `partition`: `weight` has one entry for each cell of this rank.
/// Integers that sum to at most `max_total_weight` and are not zero stay as they are; otherwise all are scaled by one
/// power of two, rounded, and become at least 1, so that a cell of no weight still counts a little.
/// Collective: two reductions. Throws `Error` on every rank, naming `what`, the value and the cell, for a wrong number
/// of weights, a negative weight, one that is not finite, and for weights that are zero everywhere.
std::vector<std::int64_t> integer_weights(const par::Comm& comm, const mesh::DistMesh& mesh,
                                          std::span<const double> weight, const std::string& what = "weights");

/// The same from a cell field of one component, real or integer. Throws `Error` on every rank also when there is none
/// of that name. Collective.
std::vector<std::int64_t> weights_from_field(const par::Comm& comm, const mesh::DistMesh& mesh,
                                             const std::string& field);

}  // namespace pamr::balance
