// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mark/recovered_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mark/recovery.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/reproducible_sum.hpp"

namespace pamr::mark {

namespace {

using geometry::Vec3;

const std::vector<double>& require_nodal(const par::Comm& comm, const mesh::DistMesh& mesh, std::string_view name) {
  const auto* field = mesh.find_node_field(name);
  if (field == nullptr) throw Error(fmt::format("expected the name of a field on nodes, found \"{}\"", name));
  if (field->n_components != 1 || field->holds_integers())
    throw Error(fmt::format("field \"{}\": expected one real component on nodes, found {}", field->name,
                            field->holds_integers() ? "integers" : fmt::format("{}", field->n_components)));
  const auto& value = field->real();
  GlobalId bad = std::numeric_limits<GlobalId>::max();
  for (std::size_t i = 0; i < value.size(); ++i)
    if (!std::isfinite(value[i])) bad = std::min(bad, mesh.node_global[i]);
  bad = comm.min(bad);
  if (bad != std::numeric_limits<GlobalId>::max())
    throw Error(fmt::format("field \"{}\": expected finite values, found another on node {}", field->name, bad));
  return value;
}

}  // namespace

RecoveredError recovered_error(const par::Comm& comm, const mesh::DistMesh& mesh, std::string_view field) {
  const auto& value = require_nodal(comm, mesh, field);
  const auto n_cells = mesh.cell_to_node.size();
  std::vector<double> volume;
  std::vector<Vec3> gradient;
  assign_array(volume, n_cells, 0.0);
  assign_array(gradient, n_cells, Vec3{});
  for (std::size_t c = 0; c < n_cells; ++c) {
    const auto p = mesh.points(static_cast<LocalId>(c));
    std::array<double, 4> at_corner{};
    for (std::size_t k = 0; k < 4; ++k) at_corner[k] = value[at(mesh.cell_to_node[c][k])];
    volume[c] = geometry::volume(p);
    gradient[c] = linear_gradient(p, at_corner, volume[c]);
  }
  const auto borders = mesh::find_borders(comm, mesh);
  const auto recovered = nodal_means<Vec3>(par::Exchange(comm, borders.nodes), mesh.node_position.size(),
                                           mesh.cell_to_node, volume, gradient);

  RecoveredError result;
  assign_array(result.squared, n_cells, 0.0);
  std::array<par::ExactSum, 2> sums;
  bool is_constant = true;
  for (std::size_t c = 0; c < n_cells; ++c) {
    auto order = mesh.cell_to_node[c];
    std::sort(order.begin(), order.end(),
              [&](LocalId i, LocalId j) { return geometry::lexicographically_less(mesh.point(i), mesh.point(j)); });
    std::array<Vec3, 4> difference;
    for (std::size_t k = 0; k < 4; ++k) difference[k] = recovered[at(order[k])] - gradient[c];
    result.squared[c] = integral_of_product(volume[c], difference, difference);
    sums[0].add(result.squared[c]);
    sums[1].add(volume[c] * squared_norm(gradient[c]));
    is_constant = is_constant && gradient[c] == Vec3{};
  }
  const auto totals = par::reproducible_sums(comm, sums);
  if (!std::isfinite(totals[0]) || !std::isfinite(totals[1]))
    throw Error(
        fmt::format("field \"{}\": expected values whose squares are finite numbers, found too large ones", field));
  constexpr double min_norm_squared = 1e-280;  // smaller ones have lost digits
  if (comm.any(!is_constant) && totals[1] < min_norm_squared)
    throw Error(
        fmt::format("field \"{}\": expected values whose squares are numbers above 0, found too small ones", field));
  result.total_squared = totals[0];
  result.norm_squared = totals[1];
  return result;
}

Indicator above_mean_share(const RecoveredError& error, Exact<GlobalId> n_global_cells, double theta) {
  if (!(theta > 0) || !std::isfinite(theta))
    throw Error(fmt::format("expected a positive share of the mean square, found {}", theta));
  const double bar = round_to_20_bits(theta * error.norm_squared / static_cast<double>(n_global_cells));
  Indicator indicator;
  reserve_array(indicator, error.squared.size());
  for (const double squared : error.squared) {
    const double excess = round_to_20_bits(squared) - bar;
    indicator.push_back(excess > 0 ? (bar > 0 ? excess / bar : excess) : 0);
  }
  return indicator;
}

Indicator bulk_of_error(const par::Comm& comm, const mesh::DistMesh& mesh, const RecoveredError& error,
                        double fraction) {
  if (!(fraction >= 0 && fraction <= 1))
    throw Error(fmt::format("expected a fraction of the error between 0 and 1, found {}", fraction));
  Indicator rounded(error.squared.size());
  std::transform(error.squared.begin(), error.squared.end(), rounded.begin(), round_to_20_bits);
  const double total = par::reproducible_sum(comm, rounded);
  if (!std::isfinite(total)) throw Error("expected values whose sum is a finite number, found too large ones");
  const double wanted = fraction * total;
  const auto share_of = [&](const std::vector<std::uint8_t>& marks) {
    std::vector<double> chosen;
    for (std::size_t i = 0; i < marks.size(); ++i)
      if (marks[i] != 0) chosen.push_back(rounded[i]);
    return par::reproducible_sum(comm, chosen);
  };
  std::int64_t too_few = -1, enough = count_marked(comm, marks_of(rounded));
  while (enough - too_few > 1) {
    const std::int64_t middle = too_few + (enough - too_few) / 2;
    (share_of(strongest(comm, mesh, rounded, middle)) >= wanted ? enough : too_few) = middle;
  }
  const auto marks = strongest(comm, mesh, rounded, enough);
  for (std::size_t i = 0; i < marks.size(); ++i)
    if (marks[i] == 0) rounded[i] = 0;
  return rounded;
}

}  // namespace pamr::mark
