// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mark/recovered_error.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <string>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/borders.hpp"
#include "pamr/mesh/tet.hpp"
#include "pamr/par/exchange.hpp"
#include "pamr/par/reproducible_sum.hpp"

namespace pamr::mark {

namespace {

using geometry::Vec3;

/// Volume and volume-weighted gradient of the cells around a node.
using Sums = std::array<std::int64_t, 4>;
using Exponents = std::array<int, 4>;

/// Bits that a term has at most in fixed point: 2^15 of them fit.
constexpr int term_bits = 48;
constexpr int no_exponent = std::numeric_limits<int>::min() / 2;

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

/// Gradient of the linear function that takes the given values in the corners. The terms are added in the order of the
/// corners' coordinates, so that it does not depend on their numbering.
Vec3 gradient(const geometry::TetPoints& p, const std::array<double, 4>& value, double volume) {
  std::array<std::size_t, 4> order{0, 1, 2, 3};
  std::sort(order.begin(), order.end(), [&](auto i, auto j) { return geometry::lexicographically_less(p[i], p[j]); });
  Vec3 sum;
  for (const auto i : order) {
    auto corner = mesh::tet::face_to_corner[i];  // its outward normal points away from corner i
    std::array<Vec3, 3> q;
    for (std::size_t k = 0; k < 3; ++k) q[k] = p[at(corner[k])];
    // Turn the face so that it begins with its first corner by coordinates: the same bits whatever the numbering.
    std::rotate(q.begin(), std::min_element(q.begin(), q.end(), geometry::lexicographically_less), q.end());
    sum = sum + (value[i] - value[order[0]]) * cross(q[1] - q[0], q[2] - q[0]);
  }
  return (-1.0 / (6.0 * volume)) * sum;
}

struct CellGradient {
  Vec3 gradient;
  double volume = 0;
  std::array<double, 4> weighted() const {
    return {volume, volume * gradient.x, volume * gradient.y, volume * gradient.z};
  }
};

int exponent_of(double value) {
  if (value == 0) return no_exponent;
  int exponent = 0;
  std::frexp(value, &exponent);
  return exponent;
}

/// Recovered gradient at each node: fixed-point sums whose unit is set by the largest term at the node.
std::vector<Vec3> recover(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<CellGradient>& cells) {
  const auto borders = mesh::find_borders(comm, mesh);
  const par::Exchange exchange(comm, borders.nodes);
  std::vector<Exponents> exponent(mesh.node_position.size(), {no_exponent, no_exponent, no_exponent, no_exponent});
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto term = cells[c].weighted();
    for (const LocalId node : mesh.cell_to_node[c])
      for (std::size_t k = 0; k < 4; ++k) {
        auto& e = exponent[at(node)][k];
        e = std::max(e, exponent_of(term[k]));
      }
  }
  par::fold_shared(exchange, exponent, [](Exponents& mine, const Exponents& theirs) {
    for (std::size_t k = 0; k < 4; ++k) mine[k] = std::max(mine[k], theirs[k]);
  });

  std::vector<Sums> sum(mesh.node_position.size(), Sums{});
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto term = cells[c].weighted();
    for (const LocalId node : mesh.cell_to_node[c])
      for (std::size_t k = 0; k < 4; ++k)
        if (term[k] != 0)
          sum[at(node)][k] +=
              static_cast<std::int64_t>(std::nearbyint(std::ldexp(term[k], term_bits - exponent[at(node)][k])));
  }
  par::fold_shared(exchange, sum, [](Sums& mine, const Sums& theirs) {
    for (std::size_t k = 0; k < 4; ++k) mine[k] += theirs[k];
  });

  std::vector<Vec3> result(sum.size());
  for (std::size_t n = 0; n < sum.size(); ++n) {
    const auto value = [&](std::size_t k) {
      return sum[n][k] == 0 ? 0.0 : std::ldexp(static_cast<double>(sum[n][k]), exponent[n][k] - term_bits);
    };
    if (sum[n][0] > 0) result[n] = {value(1) / value(0), value(2) / value(0), value(3) / value(0)};
  }
  return result;
}

}  // namespace

RecoveredError recovered_error(const par::Comm& comm, const mesh::DistMesh& mesh, std::string_view field) {
  const auto& value = require_nodal(comm, mesh, field);
  std::vector<CellGradient> cells(mesh.cell_to_node.size());
  for (std::size_t c = 0; c < cells.size(); ++c) {
    const auto p = mesh.points(static_cast<LocalId>(c));
    std::array<double, 4> at_corner{};
    for (std::size_t k = 0; k < 4; ++k) at_corner[k] = value[at(mesh.cell_to_node[c][k])];
    cells[c].volume = geometry::volume(p);
    cells[c].gradient = gradient(p, at_corner, cells[c].volume);
  }
  const auto recovered = recover(comm, mesh, cells);

  RecoveredError result;
  result.squared.resize(cells.size());
  std::array<par::ExactSum, 2> sums;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    std::array<double, 4> squares{};
    auto order = mesh.cell_to_node[c];
    std::sort(order.begin(), order.end(),
              [&](LocalId i, LocalId j) { return geometry::lexicographically_less(mesh.point(i), mesh.point(j)); });
    Vec3 total;
    for (std::size_t k = 0; k < 4; ++k) {
      const auto difference = recovered[at(order[k])] - cells[c].gradient;
      total = total + difference;
      squares[k] = squared_norm(difference);
    }
    // Integral of the product of two corner functions: V/20, V/10 of one with itself.
    const double sum = ((squares[0] + squares[1]) + squares[2]) + squares[3];
    result.squared[c] = cells[c].volume / 20.0 * (sum + squared_norm(total));
    sums[0].add(result.squared[c]);
    sums[1].add(cells[c].volume * squared_norm(cells[c].gradient));
  }
  const auto totals = par::reproducible_sums(comm, sums);
  result.total_squared = totals[0];
  result.norm_squared = totals[1];
  return result;
}

Indicator above_mean_share(const RecoveredError& error, Exact<GlobalId> n_global_cells, double theta) {
  if (!(theta > 0) || !std::isfinite(theta))
    throw Error(fmt::format("expected a positive share of the mean square, found {}", theta));
  const double bar = round_to_20_bits(theta * error.norm_squared / static_cast<double>(n_global_cells));
  Indicator indicator(error.squared.size(), 0);
  for (std::size_t i = 0; i < indicator.size(); ++i) {
    const double excess = round_to_20_bits(error.squared[i]) - bar;
    if (excess > 0) indicator[i] = bar > 0 ? excess / bar : excess;
  }
  return indicator;
}

Indicator bulk_of_error(const par::Comm& comm, const mesh::DistMesh& mesh, const RecoveredError& error,
                        double fraction) {
  if (!(fraction >= 0 && fraction <= 1))
    throw Error(fmt::format("expected a fraction of the error between 0 and 1, found {}", fraction));
  Indicator rounded(error.squared.size());
  std::transform(error.squared.begin(), error.squared.end(), rounded.begin(), round_to_20_bits);
  const double wanted = fraction * par::reproducible_sum(comm, rounded);
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
