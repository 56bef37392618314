// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mark/field_criteria.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <utility>

#include "pamr/base/contract.hpp"
#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/base/listed.hpp"
#include "pamr/geometry/tet_shape.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::mark {

namespace {

double value_at(const mesh::Field& field, std::size_t i) {
  return field.holds_integers() ? static_cast<double>(field.integer()[i]) : field.real()[i];
}

const mesh::Field& require_scalar(const mesh::Field& field) {
  if (field.n_components != 1)
    throw Error(fmt::format("field \"{}\": expected one component, found {}", field.name, field.n_components));
  return field;
}

std::string names_of(const mesh::DistMesh& mesh) {
  std::vector<std::string> names;
  for (const auto* fields : {&mesh.cell_fields, &mesh.node_fields})
    for (const auto& field : *fields) names.push_back(field.name);
  return names.empty() ? "none" : listed(names, {.most = all_items});
}

/// Throws on every rank, naming the smallest cell, when the value of any cell of any rank is bad.
template <class IsBad>
void refuse_first(const par::Comm& comm, const mesh::DistMesh& mesh, const std::vector<double>& values, IsBad is_bad,
                  const std::string& complaint) {
  constexpr GlobalId none = std::numeric_limits<GlobalId>::max();
  const auto bad = std::find_if(values.begin(), values.end(), is_bad);
  const GlobalId first = comm.min(bad == values.end() ? none : mesh.cell_global[at(bad - values.begin())]);
  if (first != none) throw Error(fmt::format("{} in cell {}", complaint, first));
}

Indicator beyond(std::vector<double> values, Side side, double threshold) {
  const double sign = side == Side::above ? 1.0 : -1.0;
  const double limit = round_to_20_bits(threshold);
  const double scale = limit != 0 ? std::abs(limit) : 1.0;
  for (auto& value : values) value = std::max(sign * (round_to_20_bits(value) - limit) / scale, 0.0);
  return values;
}

}  // namespace

std::vector<double> scalar_on_cells(const par::Comm& comm, const mesh::DistMesh& mesh, std::string_view name) {
  std::vector<double> values(mesh.cell_to_node.size());
  if (const auto* on_cells = mesh.find_cell_field(name)) {
    const auto& field = require_scalar(*on_cells);
    for (std::size_t i = 0; i < values.size(); ++i) values[i] = value_at(field, i);
  } else if (const auto* on_nodes = mesh.find_node_field(name)) {
    const auto& field = require_scalar(*on_nodes);
    for (std::size_t i = 0; i < values.size(); ++i) {
      std::array<double, 4> corner{};
      for (std::size_t k = 0; k < 4; ++k) corner[k] = value_at(field, at(mesh.cell_to_node[i][k]));
      std::sort(corner.begin(), corner.end());  // the mean must not depend on how the corners are numbered
      values[i] = 0.25 * (((corner[0] + corner[1]) + corner[2]) + corner[3]);
      if (!std::isfinite(values[i]))  // as it is where the sum is too large, though the mean is not
        values[i] = ((0.25 * corner[0] + 0.25 * corner[1]) + 0.25 * corner[2]) + 0.25 * corner[3];
    }
  } else {
    throw Error("expected the name of a field (the mesh has: " + names_of(mesh) + "), found \"" + std::string(name) +
                "\"");
  }
  refuse_first(
      comm, mesh, values, [](double v) { return !std::isfinite(v); },
      "field \"" + std::string(name) + "\": expected finite values, found another");
  return values;
}

Indicator beyond_threshold(const par::Comm& comm, const mesh::DistMesh& mesh, const Threshold& threshold) {
  return beyond(scalar_on_cells(comm, mesh, threshold.field), threshold.side, threshold.value);
}

double cell_size(const mesh::DistMesh& mesh, Exact<LocalId> cell, CellSize measure) {
  const auto p = mesh.points(cell);
  if (measure == CellSize::cbrt_volume) return std::cbrt(std::abs(geometry::volume(p)));
  double longest = 0;
  for (const auto& [a, b] : mesh::tet::edge_to_corner) longest = std::max(longest, geometry::norm(p[at(b)] - p[at(a)]));
  return longest;
}

Indicator larger_than_length(const par::Comm& comm, const mesh::DistMesh& mesh, std::string_view field, double ratio,
                             CellSize measure) {
  if (!(ratio > 0) || !std::isfinite(ratio))
    throw Error(fmt::format("expected a positive ratio of cell size to length, found {}", ratio));
  auto length = scalar_on_cells(comm, mesh, field);
  refuse_first(
      comm, mesh, length, [](double v) { return !(v > 0); },
      "field \"" + std::string(field) + "\": expected positive lengths, found another");
  const double limit = round_to_20_bits(ratio);
  Indicator indicator(length.size());
  for (std::size_t i = 0; i < length.size(); ++i) {
    const double relative = round_to_20_bits(cell_size(mesh, static_cast<LocalId>(i), measure) / length[i]);
    indicator[i] = std::max((relative - limit) / limit, 0.0);
  }
  return indicator;
}

void keep_only_where(const par::Comm& comm, const mesh::DistMesh& mesh, const Cutoff& cutoff, Indicator& indicator) {
  PAMR_EXPECTS(indicator.size() == mesh.cell_to_node.size());
  const auto& [threshold, certainty] = cutoff;
  auto values = scalar_on_cells(comm, mesh, threshold.field);
  if (!certainty.field.empty()) {
    const auto error = scalar_on_cells(comm, mesh, certainty.field);
    refuse_first(
        comm, mesh, error, [](double e) { return e < 0; },
        "field \"" + certainty.field + "\": expected errors of at least 0, found a negative one");
    const double towards = threshold.side == Side::above ? -certainty.times : certainty.times;
    for (std::size_t i = 0; i < values.size(); ++i) values[i] += towards * error[i];
  }
  const auto kept = beyond(std::move(values), threshold.side, threshold.value);
  for (std::size_t i = 0; i < indicator.size(); ++i)
    if (!(kept[i] > 0)) indicator[i] = 0;
}

}  // namespace pamr::mark
