// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/assemble/kuhn_cube.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/geometry/described_surface.hpp"

namespace pamr::assemble {

namespace {

using Axes = std::array<std::size_t, 3>;

/// Orders of the axes; the first three are even permutations, whose path gives a positive tetrahedron.
constexpr std::array<Axes, 6> axis_order{{{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {1, 0, 2}, {2, 1, 0}}};
constexpr bool is_even(std::size_t order) { return order < 3; }

std::size_t find_order(Axes axes) {
  return static_cast<std::size_t>(std::find(axis_order.begin(), axis_order.end(), axes) - axis_order.begin());
}

struct Grid {
  GlobalId n = 1;

  std::array<GlobalId, 3> cube_position(GlobalId cube) const { return {cube % n, cube / n % n, cube / (n * n)}; }
  GlobalId cube_at(const std::array<GlobalId, 3>& p) const { return p[0] + n * (p[1] + n * p[2]); }
  GlobalId node_at(const std::array<GlobalId, 3>& p) const { return p[0] + (n + 1) * (p[1] + (n + 1) * p[2]); }
};

/// Nodes along the path: w0, w1 = w0 + axis 0 of the order, w2 = w1 + axis 1, w3 = w2 + axis 2.
std::array<GlobalId, 4> path_nodes(const Grid& grid, std::array<GlobalId, 3> position, std::size_t order) {
  std::array<GlobalId, 4> node{grid.node_at(position)};
  for (std::size_t step = 0; step < 3; ++step) {
    ++position[axis_order[order][step]];
    node[step + 1] = grid.node_at(position);
  }
  return node;
}

/// Neighbors opposite w0 .. w3. Leaving through the end of the path the path is shifted by one step into the next
/// cube; through its middle two steps change places within the cube.
std::array<GlobalId, 4> path_neighbors(const Grid& grid, const std::array<GlobalId, 3>& position, std::size_t order) {
  const auto [a, b, c] = axis_order[order];
  const auto cell = [&](const std::array<GlobalId, 3>& p, Axes axes) {
    return 6 * grid.cube_at(p) + static_cast<GlobalId>(find_order(axes));
  };
  std::array<GlobalId, 4> neighbor{};
  auto next = position, previous = position;
  ++next[a];
  --previous[c];
  neighbor[0] = next[a] < grid.n ? cell(next, {b, c, a}) : -static_cast<GlobalId>(2 * a + 1) - 1;
  neighbor[1] = cell(position, {b, a, c});
  neighbor[2] = cell(position, {a, c, b});
  neighbor[3] = previous[c] >= 0 ? cell(previous, {c, a, b}) : -static_cast<GlobalId>(2 * c) - 1;
  return neighbor;
}

void describe_boundary(mesh::MeshInfo& info) {
  constexpr std::array<const char*, 6> name{"xmin", "xmax", "ymin", "ymax", "zmin", "zmax"};
  std::vector<geometry::DescribedSurface> sides;
  for (std::size_t i = 0; i < name.size(); ++i) {
    geometry::Vec3 point, outward;
    (i < 2 ? outward.x : i < 4 ? outward.y : outward.z) = i % 2 == 0 ? -1 : 1;
    if (i % 2 == 1) point = outward;
    info.patches.push_back({name[i], "patch", static_cast<int>(i)});
    sides.push_back(geometry::described_plane(name[i], geometry::whole(point), geometry::whole(outward)));
  }
  auto surfaces = geometry::set_of(sides, "Kuhn cube");
  surfaces.toml += '\n';
  info.surfaces = std::make_shared<const geometry::SurfaceSet>(std::move(surfaces));
}

}  // namespace

mesh::BlockMesh kuhn_cube(const par::Comm& comm, Exact<int> n) {
  if (n < 1 || n > 100000) throw Error(fmt::format("Kuhn cube: expected 1 to 100000 cubes along an edge, found {}", n));
  const Grid grid{n};
  mesh::BlockMesh block;
  describe_boundary(block.info);
  block.info.length_unit = std::string("1");
  block.info.n_global_cells = 6 * grid.n * grid.n * grid.n;
  block.info.n_global_nodes = (grid.n + 1) * (grid.n + 1) * (grid.n + 1);

  const auto cells = par::block_range(block.info.n_global_cells, comm.rank(), comm.size());
  block.first_cell = cells.begin;
  block.cell_to_node.reserve(static_cast<std::size_t>(cells.count()));
  block.cell_to_cell.reserve(static_cast<std::size_t>(cells.count()));
  for (GlobalId id = cells.begin; id < cells.end; ++id) {
    const auto position = grid.cube_position(id / 6);
    const auto order = static_cast<std::size_t>(id % 6);
    auto nodes = path_nodes(grid, position, order);
    auto neighbors = path_neighbors(grid, position, order);
    if (!is_even(order)) {
      std::swap(nodes[1], nodes[2]);
      std::swap(neighbors[1], neighbors[2]);
    }
    block.cell_to_node.push_back(nodes);
    block.cell_to_cell.push_back(neighbors);
  }

  const auto nodes = par::block_range(block.info.n_global_nodes, comm.rank(), comm.size());
  block.node_position.reserve(static_cast<std::size_t>(nodes.count()));
  const auto coordinate = [n](GlobalId i) { return static_cast<double>(i) / n; };
  for (GlobalId id = nodes.begin; id < nodes.end; ++id)
    block.node_position.push_back({coordinate(id % (grid.n + 1)), coordinate(id / (grid.n + 1) % (grid.n + 1)),
                                   coordinate(id / ((grid.n + 1) * (grid.n + 1)))});
  return block;
}

}  // namespace pamr::assemble
