// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mark/indicator.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "pamr/base/contract.hpp"
#include "pamr/base/memory.hpp"
#include "pamr/mesh/require_field.hpp"
#include "pamr/par/select_smallest.hpp"

namespace pamr::mark {

/// The bits of a normal number are rounded as an integer, half to even; what carries over goes into the exponent.
double round_to_20_bits(double value) {
  if (std::isnormal(value)) {
    constexpr int n_dropped = std::numeric_limits<double>::digits - 20;
    constexpr std::uint64_t unit = std::uint64_t{1} << n_dropped;
    auto bits = std::bit_cast<std::uint64_t>(value);
    bits += unit / 2 - 1 + (bits / unit % 2);
    return std::bit_cast<double>(bits / unit * unit);
  }
  if (!std::isfinite(value)) return value;
  int exponent = 0;
  const double mantissa = std::frexp(value, &exponent);
  return std::ldexp(std::nearbyint(std::ldexp(mantissa, 20)), exponent - 20);
}

void unite(Indicator& indicator, std::span<const double> other) {
  PAMR_EXPECTS(indicator.size() == other.size());
  for (std::size_t i = 0; i < other.size(); ++i) indicator[i] = std::max(indicator[i], other[i]);
}

geometry::Vec3 centroid(const mesh::DistMesh& mesh, Exact<LocalId> cell) {
  auto p = mesh.points(cell);
  std::sort(p.begin(), p.end(), geometry::lexicographically_less);
  return 0.25 * (((p[0] + p[1]) + p[2]) + p[3]);
}

std::int64_t keep_below_level(const mesh::DistMesh& mesh, Exact<int> max_level, Indicator& indicator) {
  PAMR_EXPECTS(indicator.size() == mesh.lineage.size());
  std::int64_t n_taken = 0;
  for (std::size_t i = 0; i < indicator.size(); ++i) {
    if (mesh.lineage[i].level() < max_level) continue;
    if (indicator[i] > 0) ++n_taken;
    indicator[i] = 0;
  }
  return n_taken;
}

std::vector<std::uint8_t> marks_of(std::span<const double> indicator) {
  std::vector<std::uint8_t> marks;
  reserve_array(marks, indicator.size());
  for (const double wish : indicator) marks.push_back(wish > 0 ? 1 : 0);
  return marks;
}

std::vector<std::uint8_t> strongest(const par::Comm& comm, const mesh::DistMesh& mesh,
                                    std::span<const double> indicator, Exact<std::int64_t> count) {
  PAMR_EXPECTS(indicator.size() == mesh.cell_to_node.size());
  std::vector<std::size_t> wanted;
  std::vector<par::SortKey> key;
  for (std::size_t i = 0; i < indicator.size(); ++i) {
    if (!(indicator[i] > 0)) continue;
    const auto middle = centroid(mesh, static_cast<LocalId>(i));
    wanted.push_back(i);
    key.push_back({par::ordered_bits(-indicator[i]), par::ordered_bits(middle.x), par::ordered_bits(middle.y),
                   par::ordered_bits(middle.z), static_cast<std::uint64_t>(mesh.cell_global[i])});
  }
  const auto chosen = par::select_smallest(comm, key, count);
  std::vector<std::uint8_t> marks(indicator.size(), 0);
  for (std::size_t k = 0; k < wanted.size(); ++k) marks[wanted[k]] = chosen[k];
  return marks;
}

std::int64_t count_marked(const par::Comm& comm, std::span<const std::uint8_t> marks) {
  return comm.sum(static_cast<std::int64_t>(std::count(marks.begin(), marks.end(), std::uint8_t{1})));
}

constexpr auto count_type = mesh::StorageType::uint8;

std::vector<std::int64_t> keep_in_trial(const par::Comm& comm, const mesh::DistMesh& mesh, const std::string& name,
                                        Exact<int> n_times, std::span<std::uint8_t> may_go) {
  PAMR_EXPECTS(may_go.size() == mesh.cell_to_node.size());
  const auto field_name = name + "_idle";
  std::vector<std::int64_t> idle(may_go.size(), 0);
  const auto* before = mesh.find_cell_field(field_name);
  mesh::require_replaceable(comm, mesh,
                            {field_name, "the count of how often cells could have been coarsened", 0, 255, count_type});
  for (std::size_t c = 0; c < idle.size(); ++c) {
    if (may_go[c] == 0) continue;
    const auto so_far = before == nullptr ? 0 : std::min<std::int64_t>(before->integer()[c], max_keep_for);
    idle[c] = so_far + 1;
    if (idle[c] <= n_times) may_go[c] = 0;
  }
  return idle;
}

void keep_for_a_while(const par::Comm& comm, mesh::DistMesh& mesh, const std::string& name, Exact<int> n_times,
                      std::span<std::uint8_t> may_go) {
  auto idle = keep_in_trial(comm, mesh, name, n_times, may_go);
  mesh::put_field(mesh.cell_fields, {name + "_idle", "", 1, count_type, std::move(idle)});
}

void set_marks(mesh::DistMesh& mesh, std::span<const std::uint8_t> marks, const std::string& name,
               std::span<const std::uint8_t> may_go) {
  PAMR_EXPECTS(marks.size() == mesh.cell_to_node.size());
  std::vector<std::int64_t> values(marks.begin(), marks.end());
  for (std::size_t c = 0; c < may_go.size(); ++c)
    if (may_go[c] != 0 && marks[c] == 0) values[c] = -1;
  mesh::put_field(mesh.cell_fields, {name, "", 1, mesh::StorageType::int32, std::move(values)});
}

}  // namespace pamr::mark
