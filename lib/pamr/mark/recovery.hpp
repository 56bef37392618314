// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <type_traits>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/geometry/vec3.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/sum_at_items.hpp"

/// Values at nodes recovered from those of the cells around them: for error estimates and for scales of change.
namespace pamr::mark {

/// Gradient of the linear function that takes the given values in the corners. The terms are added in the order of the
/// corners' coordinates, so that it does not depend on their numbering. Pre: `volume`, that of the cell, is positive.
/// Local.
geometry::Vec3 linear_gradient(const geometry::TetPoints& corner, const std::array<double, 4>& value, double volume);

/// Integral over a cell of the product of two vector fields that are linear in it, from their values in the corners.
/// Local.
double integral_of_product(double volume, const std::array<geometry::Vec3, 4>& a,
                           const std::array<geometry::Vec3, 4>& b);

/// Weighted mean at each node of the values, numbers or vectors, of the cells at it; 0 where there are none.
/// `for_each_term(add)` calls `add(node, weight, value)` for each node (local id) of each cell of this rank, and does
/// so twice, with the same terms. Weights are not negative. The means have the same bits for any number of ranks and
/// any order of the cells, as the sums (`par::sum_at_items`): 14 digits or more of their largest term. Pre: at most
/// 2^15 terms at a node. Collective: two exchanges of shared nodes (`exchange`). Memory of 72 bytes a node for vectors.
template <class Value, class ForEachTerm>
std::vector<Value> nodal_means(const par::Exchange& exchange, std::size_t n_nodes, const ForEachTerm& for_each_term) {
  constexpr bool is_number = std::is_same_v<Value, double>;
  constexpr std::size_t n = is_number ? 2 : 4;  // the weight, and the weighted value
  const auto sum = par::sum_at_items<n>(exchange, n_nodes, [&](const auto& add) {
    for_each_term([&](LocalId node, double weight, const Value& value) {
      if constexpr (is_number)
        add(node, {weight, weight * value});
      else
        add(node, {weight, weight * value.x, weight * value.y, weight * value.z});
    });
  });
  std::vector<Value> result(n_nodes, Value{});
  for (std::size_t node = 0; node < n_nodes; ++node) {
    const auto& total = sum[node];
    if (total[0] <= 0) continue;
    if constexpr (is_number)
      result[node] = total[1] / total[0];
    else
      result[node] = {total[1] / total[0], total[2] / total[0], total[3] / total[0]};
  }
  return result;
}

/// The same of values that are constant in each cell: `cells`, `weight` and `value` have one entry for each cell of
/// this rank. Collective.
template <class Value>
std::vector<Value> nodal_means(const par::Exchange& exchange, std::size_t n_nodes,
                               std::span<const mesh::CellNodes> cells, std::span<const double> weight,
                               std::span<const Value> value) {
  return nodal_means<Value>(exchange, n_nodes, [&](const auto& add) {
    for (std::size_t c = 0; c < cells.size(); ++c)
      for (const LocalId node : cells[c]) add(node, weight[c], value[c]);
  });
}

}  // namespace pamr::mark
