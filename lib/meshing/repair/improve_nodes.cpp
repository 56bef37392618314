// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/repair/improve_nodes.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>
#include <map>

#include "meshing/improve_node.hpp"
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

/// The cells at the nodes, whose corners are indices into `point`, where the nodes that may move come first; and the
/// limits at each of these.
struct Cavity {
  std::vector<Vec3> point;
  std::vector<std::array<std::int32_t, 4>> cell;
  std::vector<std::vector<LimitCell>> limit;
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
  cavity.limit.resize(nodes.size());
  std::map<GlobalId, std::int32_t> index;
  const auto index_of = [&](GlobalId node, const Vec3& point) {
    const auto [entry, is_unknown] = index.emplace(node, static_cast<std::int32_t>(cavity.point.size()));
    if (is_unknown) cavity.point.push_back(point);
    return entry->second;
  };
  for (const auto& node : nodes) index_of(node.node, node.point);
  for (const auto& part : parts) {
    auto& corners = cavity.cell.emplace_back();
    for (std::size_t slot = 0; slot < 4; ++slot) {
      corners[slot] = index_of(part.node[slot], part.point[slot]);
      if (at(corners[slot]) >= nodes.size() || part.patch[slot] == inner_face) continue;
      const auto* surface = info.surface_of(part.patch[slot]);
      if (surface != nullptr && !surface->is_flat())
        add_limits(*surface, part.point, slot, cavity.limit[at(corners[slot])]);
    }
  }
  return cavity;
}

double worst_limit(const std::vector<LimitCell>& limits, Vec3 apex_place) {
  double worst = std::numeric_limits<double>::infinity();
  for (const auto& [apex, p] : limits) {
    auto moved = p;
    moved[apex] = apex_place;
    worst = std::min(worst, geometry::mean_ratio(moved));
  }
  return worst;
}

bool all_positive(const Stars& stars, std::size_t n) {
  const auto cells = stars.at_node(n);
  return std::all_of(cells.begin(), cells.end(), [&](std::size_t c) {
    const auto p = stars.points(c);
    return geometry::is_positive(p[0], p[1], p[2], p[3]);
  });
}

/// Moves a node to where the worst of its cells and limits is best. True if it moved.
bool move(const Stars& stars, const std::vector<LimitCell>& limits, std::size_t n, bool is_new) {
  const double worst = worst_ratio(stars, n, refused), bound = std::min(min_ratio, worst);
  const double value = std::min(worst, worst_limit(limits, stars.point[n]));
  if (!is_new && value >= good_ratio) return false;
  return improve_node(
      stars, n, value, [](Vec3 p) { return p; },
      [&](double ratio) {
        if (ratio < bound || !all_positive(stars, n)) return refused;
        return std::min(ratio, worst_limit(limits, stars.point[n]));
      });
}

}  // namespace

std::vector<MovableNode> improve_nodes(const mesh::MeshInfo& info, std::vector<MovableNode> nodes,
                                       const std::vector<CellPart>& parts) {
  auto cavity = cavity_of(info, nodes, parts);
  const Stars stars(cavity.point, cavity.cell);
  bool has_moved = true;
  for (int sweep = 0; sweep < max_sweeps && has_moved; ++sweep) {
    has_moved = false;
    for (std::size_t n = 0; n < nodes.size(); ++n)
      has_moved = move(stars, cavity.limit[n], n, nodes[n].is_new) || has_moved;
  }
  for (std::size_t n = 0; n < nodes.size(); ++n) nodes[n].point = cavity.point[n];
  return nodes;
}

}  // namespace pamr::meshing
