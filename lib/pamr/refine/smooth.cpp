// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/smooth.hpp"

#include <algorithm>
#include <array>
#include <cmath>

namespace pamr::refine {

namespace {

using geometry::Vec3;
constexpr std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }
constexpr int n_layers = 3;

/// Largest displacement, and largest displacement over the length of the node's edge, over all ranks.
struct Extent {
  double displacement = 0;
  double ratio = 0;
};

Extent measure(const par::Comm& comm, const mesh::DistMesh& fine, const Numbering& numbering, LocalId n_old_nodes,
               const std::vector<Movable>& movables) {
  Extent here;
  for (const auto& m : movables) {
    const double d = geometry::norm(m.target - m.base);
    here.displacement = std::max(here.displacement, d);
    if (m.node < n_old_nodes) continue;
    const auto [a, b] = numbering.ends[at(m.node - n_old_nodes)];
    here.ratio = std::max(here.ratio, d / geometry::norm(fine.point(a) - fine.point(b)));
  }
  return {comm.max(here.displacement), comm.max(here.ratio)};
}

int sweeps_for(double ratio) { return ratio < 0.02 ? 0 : ratio < 0.1 ? 10 : 30; }

/// Swaps one value for each shared node and lets `take(node, theirs)` fold it in.
template <class T, class Take>
void fold_shared(const par::Exchange& exchange, const std::vector<T>& of_node, Take&& take) {
  std::vector<T> mine;
  mine.reserve(exchange.pattern().n_slots());
  for (const auto node : exchange.pattern().item) mine.push_back(of_node[at(node)]);
  const auto theirs = exchange.swap<T>(mine);
  for (std::size_t k = 0; k < theirs.size(); ++k) take(exchange.pattern().item[k], theirs[k]);
}

/// Nodes within `n_layers` cells of a moving one.
std::vector<std::uint8_t> reach(const mesh::DistMesh& fine, const par::Exchange& exchange,
                                const std::vector<Movable>& movables) {
  std::vector<std::uint8_t> reached(at(fine.n_nodes()), 0);
  for (const auto& m : movables) reached[at(m.node)] = 1;
  for (int layer = 0; layer < n_layers; ++layer) {
    auto next = reached;
    for (const auto& nodes : fine.cell_to_node)
      if (std::any_of(nodes.begin(), nodes.end(), [&](LocalId n) { return reached[at(n)] != 0; }))
        for (const auto n : nodes) next[at(n)] = 1;
    reached = std::move(next);
    fold_shared(exchange, reached, [&](LocalId node, std::uint8_t theirs) {
      if (theirs != 0) reached[at(node)] = 1;
    });
  }
  return reached;
}

using Fixed = std::array<std::int64_t, 4>;  ///< displacement in fixed point, and the number of terms in a sum

}  // namespace

void smooth_displacement(const par::Comm& comm, const mesh::DistMesh& fine, const par::Pattern& shared,
                         const Numbering& numbering, LocalId n_old_nodes, std::vector<Movable>& movables) {
  const auto extent = measure(comm, fine, numbering, n_old_nodes, movables);
  const int n_sweeps = sweeps_for(extent.ratio);
  if (n_sweeps == 0) return;
  const par::Exchange exchange(comm, shared);

  auto is_free = reach(fine, exchange, movables);
  std::fill_n(is_free.begin(), n_old_nodes, std::uint8_t{0});
  for (const auto& boundary : numbering.boundary) is_free[at(n_old_nodes + boundary.new_node)] = 0;
  std::vector<LocalId> active;
  for (LocalId c = 0; c < fine.n_cells(); ++c) {
    const auto& nodes = fine.cell_to_node[at(c)];
    if (std::any_of(nodes.begin(), nodes.end(), [&](LocalId n) { return is_free[at(n)] != 0; })) active.push_back(c);
  }

  // 40 bits for the largest displacement leave 23 for the sum of its neighbours
  const double scale = std::ldexp(1.0, 40 - std::ilogb(extent.displacement) - 1);
  std::vector<Fixed> value(at(fine.n_nodes()), Fixed{});
  for (const auto& m : movables) {
    const Vec3 d = m.target - m.base;
    value[at(m.node)] = {std::llround(d.x * scale), std::llround(d.y * scale), std::llround(d.z * scale), 0};
  }
  std::vector<Fixed> sum(value.size());
  for (int sweep = 0; sweep < n_sweeps; ++sweep) {
    std::fill(sum.begin(), sum.end(), Fixed{});
    for (const auto c : active)
      for (const auto i : fine.cell_to_node[at(c)]) {
        if (is_free[at(i)] == 0) continue;
        for (const auto j : fine.cell_to_node[at(c)]) {
          if (i == j) continue;
          for (std::size_t k = 0; k < 3; ++k) sum[at(i)][k] += value[at(j)][k];
          ++sum[at(i)][3];
        }
      }
    fold_shared(exchange, sum, [&](LocalId node, const Fixed& theirs) {
      for (std::size_t k = 0; k < 4; ++k) sum[at(node)][k] += theirs[k];
    });
    for (std::size_t i = 0; i < value.size(); ++i)
      if (is_free[i] != 0 && sum[i][3] > 0)
        for (std::size_t k = 0; k < 3; ++k) value[i][k] = sum[i][k] / sum[i][3];
  }
  for (LocalId node = n_old_nodes; node < fine.n_nodes(); ++node) {
    const auto& v = value[at(node)];
    if (is_free[at(node)] == 0 || (v[0] == 0 && v[1] == 0 && v[2] == 0)) continue;
    const Vec3 base = fine.point(node);
    const Vec3 d{static_cast<double>(v[0]) / scale, static_cast<double>(v[1]) / scale,
                 static_cast<double>(v[2]) / scale};
    movables.push_back({node, base, base + d, {-1, -1, -1, -1}, true});
  }
}

}  // namespace pamr::refine
