// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/repair/improve_nodes.hpp"

#include <algorithm>
#include <array>
#include <limits>
#include <map>

#include "pamr/base/index.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/geometry/surface.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::meshing {

namespace {

using geometry::TetPoints;
using geometry::Vec3;
constexpr double min_ratio = 0.2;   ///< mean ratio that no cell at a moved node gets below, unless it begins below
constexpr double good_ratio = 0.3;  ///< mean ratio from which on nodes of the old mesh stay where they are
constexpr int max_sweeps = 8;

/// A cell with a face on the wall as it will be at one of its corners there after many levels: the edges along the wall
/// in its tangent plane. The corner opposite the face is the node that moves.
struct LimitCell {
  std::size_t apex = 0;
  TetPoints point;
};

/// What lies at a node that may move.
struct Star {
  std::vector<std::size_t> part;
  std::vector<LimitCell> limit;
};

/// The cells at the nodes: corners as indices into `point`, where the nodes that may move come first.
struct Cavity {
  std::vector<Vec3> point;
  std::vector<std::array<std::size_t, 4>> part;
  std::vector<Star> star;

  TetPoints points(std::size_t i) const {
    const auto& corner = part[i];
    return {point[corner[0]], point[corner[1]], point[corner[2]], point[corner[3]]};
  }
};

/// The cell at each of the three corners of its face on the wall, opposite corner `apex`.
void add_limits(const geometry::Surface& surface, const TetPoints& p, std::size_t apex,
                std::vector<LimitCell>& limits) {
  for (const auto corner : mesh::tet::face_to_corner[apex]) {
    const Vec3 a = p[at(corner)], normal = surface.normal(a);
    LimitCell limit{apex, p};
    for (const auto other : mesh::tet::face_to_corner[apex]) {
      const Vec3 along = p[at(other)] - a;
      limit.point[at(other)] = a + (along - geometry::dot(along, normal) * normal);
    }
    limits.push_back(limit);
  }
}

Cavity cavity_of(const mesh::MeshInfo& info, const std::vector<MovableNode>& nodes,
                 const std::vector<CellPart>& parts) {
  Cavity cavity;
  cavity.star.resize(nodes.size());
  std::map<GlobalId, std::size_t> index;
  for (const auto& node : nodes) {
    index.emplace(node.node, cavity.point.size());
    cavity.point.push_back(node.point);
  }
  for (const auto& part : parts) {
    auto& corners = cavity.part.emplace_back();
    for (std::size_t slot = 0; slot < 4; ++slot) {
      const auto [entry, is_unknown] = index.emplace(part.node[slot], cavity.point.size());
      if (is_unknown) cavity.point.push_back(part.point[slot]);
      corners[slot] = entry->second;
      if (entry->second >= nodes.size()) continue;
      auto& star = cavity.star[entry->second];
      star.part.push_back(cavity.part.size() - 1);
      if (part.patch[slot] == inner_face) continue;
      const auto* surface = info.surface_of(part.patch[slot]);
      if (surface != nullptr && !surface->is_flat()) add_limits(*surface, part.point, slot, star.limit);
    }
  }
  return cavity;
}

double worst_part(const Cavity& cavity, std::size_t n) {
  double worst = std::numeric_limits<double>::infinity();
  for (const auto i : cavity.star[n].part) worst = std::min(worst, geometry::mean_ratio(cavity.points(i)));
  return worst;
}

double worst_limit(const Cavity& cavity, std::size_t n) {
  double worst = std::numeric_limits<double>::infinity();
  for (const auto& [apex, p] : cavity.star[n].limit) {
    auto moved = p;
    moved[apex] = cavity.point[n];
    worst = std::min(worst, geometry::mean_ratio(moved));
  }
  return worst;
}

double shortest_edge(const Cavity& cavity, std::size_t n) {
  double shortest = std::numeric_limits<double>::infinity();
  for (const auto i : cavity.star[n].part)
    for (const auto corner : cavity.part[i])
      if (corner != n) shortest = std::min(shortest, geometry::norm(cavity.point[corner] - cavity.point[n]));
  return shortest;
}

bool all_positive(const Cavity& cavity, std::size_t n) {
  const auto& parts = cavity.star[n].part;
  return std::all_of(parts.begin(), parts.end(), [&](std::size_t i) {
    const auto p = cavity.points(i);
    return geometry::is_positive(p[0], p[1], p[2], p[3]);
  });
}

/// Tries the 26 neighbors in a cube about the best place so far, in ever smaller cubes. True when the node moved.
bool move(Cavity& cavity, std::size_t n, bool is_new) {
  auto& p = cavity.point[n];
  const Vec3 start = p;
  const double worst = worst_part(cavity, n), bound = std::min(min_ratio, worst), length = shortest_edge(cavity, n);
  double best = std::min(worst, worst_limit(cavity, n));
  if (!is_new && best >= good_ratio) return false;
  Vec3 best_place = start;
  for (double step = 0.2; step > 0.01; step *= 0.5) {
    const Vec3 center = best_place;
    for (int direction = 0; direction < 27; ++direction) {
      if (direction == 13) continue;  // the center
      const int x = direction % 3, y = direction / 3 % 3, z = direction / 9;
      const Vec3 d{x - 1.0, y - 1.0, z - 1.0};
      p = center + (step * length / geometry::norm(d)) * d;
      const double parts = worst_part(cavity, n), value = std::min(parts, worst_limit(cavity, n));
      if (parts < bound || !(value > best) || !all_positive(cavity, n)) continue;
      best = value;
      best_place = p;
    }
  }
  p = best_place;
  return !(p == start);
}

}  // namespace

std::vector<MovableNode> improve_nodes(const mesh::MeshInfo& info, std::vector<MovableNode> nodes,
                                       const std::vector<CellPart>& parts) {
  auto cavity = cavity_of(info, nodes, parts);
  bool has_moved = true;
  for (int sweep = 0; sweep < max_sweeps && has_moved; ++sweep) {
    has_moved = false;
    for (std::size_t n = 0; n < nodes.size(); ++n) has_moved = move(cavity, n, nodes[n].is_new) || has_moved;
  }
  for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n].point = cavity.point[n];
  return nodes;
}

}  // namespace pamr::meshing
