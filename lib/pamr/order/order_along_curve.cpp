// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/order/order_along_curve.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "pamr/assemble/check_block.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/mesh/box_of_nodes.hpp"
#include "pamr/order/hilbert.hpp"
#include "pamr/order/order_here.hpp"
#include "pamr/order/order_over_ranks.hpp"

namespace pamr::order {

namespace {

using Quad = std::array<GlobalId, 4>;

constexpr GlobalId cells_of_small_mesh = GlobalId{1} << 15U;
constexpr GlobalId far_cell = GlobalId{1} << 13U;
constexpr GlobalId far_node = GlobalId{1} << 11U;

/// In unsigned arithmetic: nobody has looked at the numbers yet.
bool is_near(GlobalId a, GlobalId b, GlobalId span) {
  const auto reach = static_cast<std::uint64_t>(span);
  return static_cast<std::uint64_t>(a) - static_cast<std::uint64_t>(b) + reach <= 2 * reach;
}

int count_lonely(const Quad& n) {
  const auto near = [](GlobalId a, GlobalId b) { return is_near(a, b, far_node) ? 1 : 0; };
  const int n01 = near(n[0], n[1]), n02 = near(n[0], n[2]), n03 = near(n[0], n[3]);
  const int n12 = near(n[1], n[2]), n13 = near(n[1], n[3]), n23 = near(n[2], n[3]);
  return 4 - (n01 | n02 | n03) - (n01 | n12 | n13) - (n02 | n12 | n23) - (n03 | n13 | n23);
}

void count_far_neighbors(const mesh::BlockMesh& block, Disorder& disorder) {
  auto cell = block.first_cell;
  for (const auto& neighbors : block.cell_to_cell) {
    for (const auto other : neighbors) {
      disorder.links += other < 0 ? 0 : 1;
      disorder.far_links += other < 0 || is_near(cell, other, far_cell) ? 0 : 1;
    }
    ++cell;
  }
}

bool have_common_node(const Quad& a, const Quad& b) {
  return std::any_of(a.begin(), a.end(), [&](GlobalId node) { return std::find(b.begin(), b.end(), node) != b.end(); });
}

/// The last cell on the ranks before this one. Collective.
Quad last_before(const par::Comm& comm, const std::vector<Quad>& cells) {
  const auto n = comm.all_gather(static_cast<std::int64_t>(cells.size()));
  auto before = comm.rank();
  while (before > 0 && n[static_cast<std::size_t>(before - 1)] == 0) --before;
  Quad last{};
  for (std::size_t i = 0; i < 4; ++i) {
    const auto all = comm.all_gather(cells.empty() ? -1 : cells.back()[i]);
    last[i] = before == 0 ? -1 : all[static_cast<std::size_t>(before - 1)];
  }
  return last;
}

void count_unconnected(const par::Comm& comm, const mesh::BlockMesh& block, Disorder& disorder) {
  auto last = last_before(comm, block.cell_to_node);
  for (const auto& nodes : block.cell_to_node) {
    if (last[0] != -1) {
      ++disorder.links;
      disorder.far_links += have_common_node(last, nodes) ? 0 : 1;
    }
    last = nodes;
  }
}

/// Grid over the box of all finite coordinates of the nodes. Collective: one reduction.
CurveGrid grid_over(const par::Comm& comm, const std::vector<geometry::Vec3>& points) {
  const auto finite = [](double x) { return std::isfinite(x) ? x : std::numeric_limits<double>::quiet_NaN(); };
  geometry::Box box;
  for (const auto p : points) box.extend({finite(p.x), finite(p.y), finite(p.z)});
  return CurveGrid(mesh::box_over_ranks(comm, box));
}

}  // namespace

Disorder measure_disorder(const par::Comm& comm, const mesh::BlockMesh& block) {
  if (block.info.n_global_cells <= cells_of_small_mesh) return {};
  Disorder disorder;
  if (comm.any(!block.cell_to_cell.empty()))
    count_far_neighbors(block, disorder);
  else
    count_unconnected(comm, block, disorder);
  for (const auto& nodes : block.cell_to_node) disorder.lonely_corners += count_lonely(nodes);
  std::array<std::int64_t, 4> sum{disorder.links, disorder.far_links,
                                  4 * static_cast<std::int64_t>(block.cell_to_node.size()), disorder.lonely_corners};
  comm.sum_in_place(sum);
  return {sum[0], sum[1], sum[2], sum[3]};
}

Ordered order_along_curve(const par::Comm& comm, mesh::BlockMesh block) {
  const auto contents = assemble::check_block(comm, block, {});
  assemble::family_destinations(comm, block, {}, contents);
  const auto grid = grid_over(comm, block.node_position);
  if (comm.size() == 1) return order_here(std::move(block), grid);
  return order_over_ranks(comm, std::move(block), grid, contents);
}

}  // namespace pamr::order
