// SPDX-License-Identifier: GPL-3.0-or-later
#include "coarse_walls.hpp"

#include <algorithm>
#include <map>
#include <numeric>

#include "pamr/base/index.hpp"
#include "pamr/mesh/tet.hpp"
#include "support/dice.hpp"
#include "support/round_bodies.hpp"

namespace pamr::test {

namespace {

using curved::CellBulges;
using geometry::Vec3;
using Barycentric = std::array<double, 4>;

constexpr std::array<double, 5> radii{1, 1.3, 1.8, 2.6, 4};

/// From a point to the sphere of this radius.
Vec3 to_sphere(double radius, Vec3 p) { return (radius / norm(p)) * p - p; }

/// Radius of the wall that a node of the shell lies on; 0 inside.
double wall_of(Vec3 node) {
  for (const double radius : {radii.front(), radii.back()})
    if (std::abs(norm(node) - radius) < 1e-9) return radius;
  return 0;
}

Vec3 quadratic_map(const geometry::TetPoints& corner, const CellBulges& bulge, const Barycentric& l) {
  Vec3 x;
  for (std::size_t i = 0; i < 4; ++i) x += l[i] * corner[i];
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = mesh::tet::edge_to_corner[e];
    x += 4 * l[at(a)] * l[at(b)] * bulge[e];
  }
  return x;
}

/// The walls' residual at a point: that at the point of the face or edge opposite, where the rest of the cell is as far
/// away as the square of what is left says; edges that two faces share are counted once.
Vec3 residual_at(const geometry::TetPoints& corner, const CellBulges& bulge, const Barycentric& l) {
  const auto of_corners = [&](const std::vector<std::size_t>& corners) {
    const double radius = wall_of(corner[corners[0]]);
    double weight = 0;
    for (const auto i : corners) {
      if (wall_of(corner[i]) != radius) return Vec3{};
      weight += l[i];
    }
    if (radius == 0 || weight < 1e-12) return Vec3{};
    Barycentric on_wall{};
    for (const auto i : corners) on_wall[i] = l[i] / weight;
    return weight * weight * to_sphere(radius, quadratic_map(corner, bulge, on_wall));
  };
  const auto is_wall = [&](std::size_t a, std::size_t b) {
    return wall_of(corner[a]) != 0 && wall_of(corner[a]) == wall_of(corner[b]);
  };
  Vec3 sum;
  std::array<double, 6> n_faces{};  // on a wall, of each edge
  for (std::size_t f = 0; f < 4; ++f) {
    const auto face = mesh::tet::face_to_corner[f];
    sum += of_corners({at(face[0]), at(face[1]), at(face[2])});
    const bool lies_on_wall = is_wall(at(face[0]), at(face[1])) && is_wall(at(face[0]), at(face[2]));
    for (std::size_t e = 0; e < 6; ++e)
      if (lies_on_wall && (mesh::tet::face_edge_mask[f] >> e & 1U) != 0) n_faces[e] += 1;
  }
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = mesh::tet::edge_to_corner[e];
    if (is_wall(at(a), at(b))) sum += (1 - n_faces[e]) * of_corners({at(a), at(b)});
  }
  return sum;
}

/// By differences; at the corners the residual vanishes in second order.
curved::SampledRows differentiate_residual(const geometry::TetPoints& corner, const CellBulges& bulge) {
  constexpr double h = 1e-5;
  curved::SampledRows rows{};
  for (std::size_t q = 0; q < curved::sample_points.size(); ++q) {
    const auto& l = curved::sample_points[q];
    if (*std::max_element(l.begin(), l.end()) > 0.99) continue;
    for (std::size_t a = 0; a < 3; ++a) {
      auto more = l, less = l;
      more[a + 1] += h;
      more[0] -= h;
      less[a + 1] -= h;
      less[0] += h;
      rows[q][a] = (1 / (2 * h)) * (residual_at(corner, bulge, more) - residual_at(corner, bulge, less));
    }
  }
  return rows;
}

}  // namespace

WholeCells icosahedral_shell() {
  const auto ball = test::ball(par::Comm(MPI_COMM_SELF));
  const auto n = ball.node_position.size() - 1;  // without the center, which is node 0
  WholeCells shell;
  for (const double r : radii)
    for (std::size_t i = 1; i <= n; ++i) shell.node.push_back(r * ball.node_position[i]);
  for (std::size_t layer = 0; layer + 1 < radii.size(); ++layer)
    for (auto face : ball.cell_to_node) {
      std::sort(face.begin(), face.end());
      std::array<std::size_t, 3> low{}, high{};
      for (std::size_t i = 0; i < 3; ++i) {
        low[i] = at(face[i + 1]) - 1 + layer * n;
        high[i] = low[i] + n;
      }
      shell.cell.push_back({low[0], low[1], low[2], high[2]});
      shell.cell.push_back({low[0], low[1], high[1], high[2]});
      shell.cell.push_back({low[0], high[0], high[1], high[2]});
    }
  return shell;
}

WholeZone zone_of(const WholeCells& cells) {
  WholeZone whole;
  std::map<std::array<std::size_t, 2>, LocalId> number;
  std::vector<std::array<std::size_t, 4>> sorted = cells.cell;
  for (auto& nodes : sorted) {
    std::sort(nodes.begin(), nodes.end(),
              [&](auto a, auto b) { return geometry::lexicographically_less(cells.node[a], cells.node[b]); });
    for (const auto& [a, b] : mesh::tet::edge_to_corner)
      number[{std::min(nodes[at(a)], nodes[at(b)]), std::max(nodes[at(a)], nodes[at(b)])}] = 0;
  }
  for (auto& [nodes, edge] : number) {
    edge = static_cast<LocalId>(whole.edge_to_node.size());
    whole.edge_to_node.push_back(nodes);
  }
  for (const auto& nodes : sorted) {
    whole.zone.corner.push_back(
        {cells.node[nodes[0]], cells.node[nodes[1]], cells.node[nodes[2]], cells.node[nodes[3]]});
    auto& edges = whole.zone.cell_to_edge.emplace_back();
    for (std::size_t e = 0; e < 6; ++e) {
      const auto [a, b] = mesh::tet::edge_to_corner[e];
      edges[e] = number.at({std::min(nodes[at(a)], nodes[at(b)]), std::max(nodes[at(a)], nodes[at(b)])});
    }
  }
  whole.zone.bulge.resize(whole.edge_to_node.size());
  whole.zone.freedom.resize(whole.edge_to_node.size());
  return whole;
}

curved::BulgeZone shell_zone() {
  const auto shell = icosahedral_shell();
  auto [zone, edge_to_node] = zone_of(shell);
  for (std::size_t e = 0; e < edge_to_node.size(); ++e) {
    const Vec3 a = shell.node[edge_to_node[e][0]], b = shell.node[edge_to_node[e][1]];
    const double radius = wall_of(a);
    if (radius != 0 && radius == wall_of(b))
      zone.bulge[e] = to_sphere(radius, midpoint(a, b));
    else
      zone.freedom[e].kind = curved::Freedom::Kind::any;
  }
  for (std::size_t c = 0; c < zone.corner.size(); ++c) {
    CellBulges bulge;
    for (std::size_t e = 0; e < 6; ++e) bulge[e] = zone.bulge[at(zone.cell_to_edge[c][e])];
    zone.walls.cell_to_rows.push_back(static_cast<LocalId>(zone.walls.rows.size()));
    zone.walls.rows.push_back(differentiate_residual(zone.corner[c], bulge));
  }
  return zone;
}

PartOfZone part_of(const par::Comm& comm, const curved::BulgeZone& whole, std::uint64_t seed, Rank n_owners) {
  Dice dice(seed);  // the same draws on every rank
  std::vector<std::size_t> cells(whole.corner.size()), edges(whole.bulge.size());
  std::iota(cells.begin(), cells.end(), std::size_t{0});
  std::iota(edges.begin(), edges.end(), std::size_t{0});
  dice.shuffle(cells);
  dice.shuffle(edges);
  std::vector<std::vector<bool>> is_held(at(comm.size()), std::vector<bool>(edges.size(), false));
  PartOfZone part;
  for (const auto c : cells) {
    const auto owner = dice.below(at(n_owners));
    for (const auto e : whole.cell_to_edge[c]) is_held[owner][at(e)] = true;
    if (owner != at(comm.rank())) continue;
    part.zone.corner.push_back(whole.corner[c]);
    part.zone.cell_to_edge.push_back(whole.cell_to_edge[c]);
    if (whole.walls.rows.empty()) continue;
    part.zone.walls.cell_to_rows.push_back(static_cast<LocalId>(part.zone.walls.rows.size()));
    part.zone.walls.rows.push_back(whole.walls.rows[at(whole.walls.cell_to_rows[c])]);
  }
  std::vector<LocalId> here(edges.size(), -1);
  for (const auto e : edges) {
    if (!is_held[at(comm.rank())][e]) continue;
    here[e] = static_cast<LocalId>(part.edge_in_whole.size());
    part.edge_in_whole.push_back(static_cast<LocalId>(e));
    part.zone.bulge.push_back(whole.bulge[e]);
    part.zone.freedom.push_back(whole.freedom[e]);
  }
  for (auto& of_cell : part.zone.cell_to_edge)
    for (auto& e : of_cell) e = here[at(e)];
  for (Rank rank = 0; rank < comm.size(); ++rank) {
    if (rank == comm.rank()) continue;
    auto& shared = part.zone.shared;
    for (std::size_t e = 0; e < edges.size(); ++e)
      if (here[e] >= 0 && is_held[at(rank)][e]) shared.item.push_back(here[e]);
    if (shared.item.size() == shared.offset.back()) continue;
    shared.rank.push_back(rank);
    shared.offset.push_back(shared.item.size());
  }
  return part;
}

}  // namespace pamr::test
