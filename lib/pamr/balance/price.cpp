// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/balance/price.hpp"

#include <array>
#include <vector>

namespace pamr::balance {

namespace {

/// What a face between ranks costs each of the two, in cells: 46,882 faces between 16 ranks add 39 ms to the 496 ms of
/// one rank for 1,070,179 cells (`bench/scaling.sh`).
constexpr double cells_of_face = 1;
/// What PT-Scotch costs for each vertex of a rank, in cells: 0.04 s of processor time for 500 on each of two ranks.
constexpr double cells_of_vertex = 200;

}  // namespace

bool meets(const Quality& quality, const Options& options) {
  if (quality.imbalance > options.keep_below) return false;
  return options.method == Method::blocks ||
         static_cast<double>(quality.edge_cut) <= options.max_cut * quality.compact_cut;
}

double work_of_pass(const Quality& quality, Size size) {
  const auto n_parts = static_cast<double>(size.n_parts);
  return static_cast<double>(size.n_cells) / n_parts * quality.imbalance +
         cells_of_face * 2 * static_cast<double>(quality.edge_cut) / n_parts;
}

double work_with_scotch(Size size, const Options& options) {
  const std::vector<std::int64_t> even(static_cast<std::size_t>(size.n_parts), size.n_cells / size.n_parts);
  Quality expected;
  expected.imbalance = 1 + options.tolerance;
  expected.edge_cut = static_cast<std::int64_t>(faces_between_compact_parts(even));
  const auto n_vertices = static_cast<double>(options.vertices_per_part == 0 ? size.n_cells / size.n_parts
                                                                             : std::int64_t{options.vertices_per_part});
  return cells_of_vertex * n_vertices + options.passes * work_of_pass(expected, size);
}

bool is_gain(const Quality& before, const Quality& after, Size size, const Options& options) {
  if (meets(after, options)) return true;  // `before` does not, or nobody would ask
  return work_of_pass(after, size) <= 0.99 * work_of_pass(before, size);
}

}  // namespace pamr::balance
