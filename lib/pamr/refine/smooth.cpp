// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/smooth.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/par/exchange.hpp"

namespace pamr::refine {

namespace {

using geometry::Vec3;
constexpr int n_layers = 3;

/// Largest displacement, and largest displacement over the length of the node's edge, over all ranks.
struct Extent {
  double displacement = 0;
  double ratio = 0;
  std::vector<LocalId> seeds;  ///< this rank's nodes that neighbors should follow
};

Extent measure(const par::Comm& comm, const NewLevel& level, const std::vector<Vec3>& position,
               const std::vector<Movable>& movables) {
  const auto& numbering = level.numbering;
  Extent here;
  for (const auto& m : movables) {
    const double d = geometry::norm(m.target - m.base);
    here.displacement = std::max(here.displacement, d);
    double ratio = 1;  // old nodes off their surface are to be helped in any case
    if (m.node >= numbering.n_old_nodes) {
      const auto [a, b] = numbering.ends[at(m.node - numbering.n_old_nodes)];
      ratio = d / geometry::norm(position[at(a)] - position[at(b)]);
      here.ratio = std::max(here.ratio, ratio);
    }
    if (ratio >= gentle_ratio) here.seeds.push_back(m.node);
  }
  return {comm.max(here.displacement), comm.max(here.ratio), std::move(here.seeds)};
}

int sweeps_for(double ratio) { return ratio < gentle_ratio ? 0 : ratio < 0.1 ? 10 : 30; }

bool any_of(const std::vector<std::uint8_t>& flag, const mesh::CellNodes& nodes) {
  return (flag[at(nodes[0])] | flag[at(nodes[1])] | flag[at(nodes[2])] | flag[at(nodes[3])]) != 0;
}

/// Nodes within `n_layers` cells of a seed.
std::vector<std::uint8_t> reach(const NewLevel& level, const par::Exchange& exchange,
                                const std::vector<LocalId>& seeds) {
  std::vector<std::uint8_t> reached(level.n_nodes(), 0);
  for (const auto node : seeds) reached[at(node)] = 1;
  for (int layer = 0; layer < n_layers; ++layer) {
    auto next = reached;
    for (const auto& nodes : level.children.cell_to_node)
      if (any_of(reached, nodes))
        for (const auto n : nodes) next[at(n)] = 1;
    reached = std::move(next);
    par::fold_flags(exchange, reached);
  }
  return reached;
}

using Fixed = std::array<std::int64_t, 3>;  ///< displacement in fixed point

/// A node that stays in a plane: its number in the region, and the unit normal.
struct InPlane {
  std::size_t number = 0;
  Vec3 normal;
};

/// The cells at free nodes, with their nodes numbered among themselves, so that the sweeps stay within little memory.
struct Region {
  std::vector<LocalId> number;        ///< of each node of the mesh; -1 outside
  std::vector<LocalId> node;          ///< of each number
  std::vector<std::uint8_t> is_free;  ///< of each number
  std::vector<mesh::CellNodes> cell_to_number;
  std::vector<InPlane> in_plane;  ///< free nodes that stay in a plane
};

Region gather(const NewLevel& level, const std::vector<std::uint8_t>& is_free) {
  Region region;
  region.number.assign(level.n_nodes(), -1);
  for (const auto& nodes : level.children.cell_to_node) {
    if (!any_of(is_free, nodes)) continue;
    auto& numbers = region.cell_to_number.emplace_back();
    for (std::size_t i = 0; i < 4; ++i) {
      auto& number = region.number[at(nodes[i])];
      if (number < 0) {
        number = static_cast<LocalId>(region.node.size());
        region.node.push_back(nodes[i]);
        region.is_free.push_back(is_free[at(nodes[i])]);
      }
      numbers[i] = number;
    }
  }
  return region;
}

/// The free nodes that other ranks hold too, in the numbers of the region: only their sums are put together. Adds what
/// the other ranks have to `n_terms`. Collective: one exchange over all shared nodes.
par::Pattern share_free(const par::Exchange& exchange, const Region& region, std::vector<std::int32_t>& n_terms) {
  const auto& node = exchange.pattern().item;
  std::vector<std::int32_t> mine;
  mine.reserve(node.size());
  for (const auto n : node) {
    const auto number = region.number[at(n)];
    mine.push_back(number >= 0 && region.is_free[at(number)] != 0 ? n_terms[at(number)] : -1);
  }
  const auto theirs = exchange.swap<std::int32_t>(mine);
  return par::restricted(exchange.pattern(), [&](std::size_t k) {
    if (mine[k] < 0 || theirs[k] < 0) return invalid_local;
    const auto number = region.number[at(node[k])];
    n_terms[at(number)] += theirs[k];
    return number;
  });
}

/// For each node of the region the sum over its cells of the values at their other corners.
void sum_neighbors(const Region& region, const std::vector<Fixed>& value, std::vector<Fixed>& sum) {
  std::fill(sum.begin(), sum.end(), Fixed{});
  for (const auto& numbers : region.cell_to_number) {
    Fixed all{};
    for (const auto i : numbers)
      for (std::size_t k = 0; k < 3; ++k) all[k] += value[at(i)][k];
    for (const auto i : numbers)
      for (std::size_t k = 0; k < 3; ++k) sum[at(i)][k] += all[k] - value[at(i)][k];
  }
}

/// The planes that new nodes lie in within one patch.
std::vector<std::pair<LocalId, const geometry::Surface*>> planes_of_nodes(const NewLevel& level) {
  std::vector<const geometry::Surface*> plane_of_patch;
  for (const auto& patch : level.info.patches) {
    const auto* surface = level.surfaces.get(patch.surface);
    plane_of_patch.push_back(surface != nullptr && surface->is_flat() ? surface : nullptr);
  }
  std::vector<std::pair<LocalId, const geometry::Surface*>> planes;
  for (const auto& boundary : level.numbering.boundary)
    planes.emplace_back(level.numbering.n_old_nodes + boundary.new_node,
                        boundary.patch[0] == boundary.patch[1] ? plane_of_patch[at(boundary.patch[0])] : nullptr);
  return planes;
}

void stay_in_planes(const std::vector<InPlane>& in_plane, std::vector<Fixed>& value) {
  for (const auto& node : in_plane) {
    auto& v = value[node.number];
    const Vec3 n = node.normal;
    const double out =
        n.x * static_cast<double>(v[0]) + n.y * static_cast<double>(v[1]) + n.z * static_cast<double>(v[2]);
    v[0] -= std::llround(out * n.x);
    v[1] -= std::llround(out * n.y);
    v[2] -= std::llround(out * n.z);
  }
}

/// The values after `n_sweeps` times replacing those at free nodes by the mean over their neighbors, all at once.
std::vector<Fixed> sweep(const par::Comm& comm, const par::Exchange& exchange, const Region& region, int n_sweeps,
                         std::vector<Fixed> value) {
  std::vector<std::int32_t> n_terms(value.size(), 0);
  for (const auto& numbers : region.cell_to_number)
    for (const auto i : numbers) n_terms[at(i)] += 3;
  const auto shared = share_free(exchange, region, n_terms);
  std::vector<Fixed> sum(value.size());
  for (int i = 0; i < n_sweeps; ++i) {
    sum_neighbors(region, value, sum);
    par::fold_shared(par::Exchange(comm, shared), sum, [](Fixed& mine, const Fixed& theirs) {
      for (std::size_t d = 0; d < 3; ++d) mine[d] += theirs[d];
    });
    for (std::size_t n = 0; n < value.size(); ++n)
      if (region.is_free[n] != 0)
        for (std::size_t k = 0; k < 3; ++k) value[n][k] = sum[n][k] / n_terms[n];
    stay_in_planes(region.in_plane, value);
  }
  return value;
}

}  // namespace

Smoothed smooth_displacement(const par::Comm& comm, const NewLevel& level, const std::vector<geometry::Vec3>& position,
                             const Movement& movement) {
  const auto& movables = movement.nodes;
  const auto extent = measure(comm, level, position, movables);
  Smoothed smoothed;
  smoothed.max_ratio = extent.ratio;
  const int n_sweeps = sweeps_for(extent.ratio);
  if (n_sweeps == 0) return smoothed;
  const par::Exchange exchange(comm, level.shared);

  auto is_free = reach(level, exchange, extent.seeds);
  smoothed.reaches_open = any_open(level, is_free);
  std::fill_n(is_free.begin(), level.numbering.n_old_nodes, std::uint8_t{0});
  const auto planes = planes_of_nodes(level);
  for (const auto& [node, plane] : planes)
    if (plane == nullptr) is_free[at(node)] = 0;
  for (const auto node : movement.held) is_free[at(node)] = 0;
  auto region = gather(level, is_free);
  std::vector<const geometry::Surface*> plane_of(region.node.size(), nullptr);
  for (const auto& [node, plane] : planes) {
    if (is_free[at(node)] == 0) continue;
    const auto number = at(region.number[at(node)]);
    region.in_plane.push_back({number, plane->normal(position[at(node)])});
    plane_of[number] = plane;
  }

  // 40 bits for the largest displacement leave 23 for the sum of its neighbors
  const double scale = std::ldexp(1.0, 40 - std::ilogb(extent.displacement) - 1);
  std::vector<Fixed> value(region.node.size(), Fixed{});
  for (const auto& m : movables) {
    const auto number = region.number[at(m.node)];
    if (number < 0) continue;
    const Vec3 d = m.target - m.base;
    value[at(number)] = {std::llround(d.x * scale), std::llround(d.y * scale), std::llround(d.z * scale)};
  }
  value = sweep(comm, exchange, region, n_sweeps, std::move(value));
  for (std::size_t number = 0; number < value.size(); ++number) {
    const auto node = region.node[number];
    const auto& v = value[number];
    if (region.is_free[number] == 0 || v == Fixed{}) continue;
    const Vec3 base = position[at(node)];
    const Vec3 d{static_cast<double>(v[0]) / scale, static_cast<double>(v[1]) / scale,
                 static_cast<double>(v[2]) / scale};
    const auto target = plane_of[number] == nullptr ? base + d : plane_of[number]->project(base + d);
    smoothed.followers.push_back({node, base, target, {-1, -1, -1, -1}, true, false});
  }
  return smoothed;
}

}  // namespace pamr::refine
