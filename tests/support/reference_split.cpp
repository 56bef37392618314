// SPDX-License-Identifier: GPL-3.0-or-later
#include "support/reference_split.hpp"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "pamr/geometry/orientation.hpp"

namespace pamr::test {

namespace {

using mesh::tet::edge_to_corner;
using Quad = std::array<GlobalId, 4>;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// The four cells at an inner diagonal: each holds both its ends and two neighboring nodes of the ring of the other
/// four middles. `m[e]` is the middle of edge e. Two middles of that ring are neighbors unless their edges are
/// opposite ones. Orientation is looked up in a cell with simple numbers.
std::vector<Quad> cells_round_diagonal(const std::array<GlobalId, 6>& m, int diagonal) {
  const std::array<geometry::Vec3, 4> simple{{{0, 0, 0}, {2, 0, 0}, {0, 2, 0}, {0, 0, 2}}};
  const auto middle = [&](int e) {
    return geometry::midpoint(simple[at(edge_to_corner[at(e)][0])], simple[at(edge_to_corner[at(e)][1])]);
  };
  std::vector<Quad> cells;
  for (int e = 0; e < 6; ++e)
    for (int g = e + 1; g < 6; ++g) {
      if (EdgeSet{e, g, diagonal, 5 - diagonal}.size() != 4 || e + g == 5) continue;
      const bool is_positive = geometry::volume({middle(diagonal), middle(5 - diagonal), middle(e), middle(g)}) > 0;
      cells.push_back({m[at(diagonal)], m[at(5 - diagonal)], m[at(is_positive ? e : g)], m[at(is_positive ? g : e)]});
    }
  return cells;
}

bool is_positive(const Quad& cell, const Points& point) {
  const auto p = points_of(cell, point);
  return geometry::is_positive(p[0], p[1], p[2], p[3]);
}

std::array<geometry::Vec3, 2> sorted_ends(const std::array<GlobalId, 6>& m, int diagonal, const Points& point) {
  std::array<geometry::Vec3, 2> ends{point[at(m[at(diagonal)])], point[at(m[at(5 - diagonal)])]};
  std::sort(ends.begin(), ends.end(), geometry::lexicographically_less);
  return ends;
}

/// The shortest; among those equal to rounding the one whose worst inner cell is best; then by coordinates.
int choose_diagonal(const std::array<GlobalId, 6>& m, const Points& point, bool only_positive) {
  std::vector<int> candidates{0, 1, 2};
  if (only_positive) {
    std::vector<int> positive;
    for (const int d : candidates) {
      const auto cells = cells_round_diagonal(m, d);
      if (std::all_of(cells.begin(), cells.end(), [&](const Quad& c) { return is_positive(c, point); }))
        positive.push_back(d);
    }
    if (!positive.empty()) candidates = positive;
  }
  // narrows the candidates to those that are as good as the best
  const auto keep_best = [&candidates](const auto& cost, double factor) {
    double least = cost(candidates.front());
    for (const int d : candidates) least = std::min(least, cost(d));
    std::erase_if(candidates, [&](int d) { return cost(d) > (least < 0 ? least / factor : least * factor); });
  };
  keep_best([&](int d) { return squared_norm(point[at(m[at(d)])] - point[at(m[at(5 - d)])]); }, rounding);
  keep_best(
      [&](int d) {
        double worst = 1;
        for (const auto& cell : cells_round_diagonal(m, d))
          worst = std::min(worst, geometry::mean_ratio(points_of(cell, point)));
        return -worst;
      },
      rounding);
  return *std::min_element(candidates.begin(), candidates.end(), [&](int a, int b) {
    const auto p = sorted_ends(m, a, point), q = sorted_ends(m, b, point);
    return std::lexicographical_compare(p.begin(), p.end(), q.begin(), q.end(), geometry::lexicographically_less);
  });
}

/// A child's face has the patch of the parent's face in which all its nodes lie.
void inherit_patches(const Piece& parent, const Middles& middle, std::vector<Piece>& children) {
  std::array<std::set<GlobalId>, 4> nodes_on;
  for (std::size_t face = 0; face < 4; ++face) nodes_on[face] = nodes_on_face(parent, middle, face);
  for (auto& child : children)
    for (std::size_t slot = 0; slot < 4; ++slot)
      for (std::size_t face = 0; face < 4; ++face) {
        const auto& on_face = nodes_on[face];
        bool lies_on_it = true;
        for (std::size_t i = 0; i < 4; ++i)
          lies_on_it = lies_on_it && (i == slot || on_face.count(child.corner[i]) != 0);
        if (lies_on_it) child.patch[slot] = parent.patch[face];
      }
}

}  // namespace

Edge Piece::edge(int number) const {
  const auto [a, b] = edge_to_corner[at(number)];
  return edge_between(corner[at(a)], corner[at(b)]);
}

Quad Piece::with(std::size_t slot, GlobalId node) const {
  auto result = corner;
  result[slot] = node;
  return result;
}

geometry::TetPoints points_of(const Quad& corner, const Points& point) {
  return {point[at(corner[0])], point[at(corner[1])], point[at(corner[2])], point[at(corner[3])]};
}

EdgeSet edges_of_face(int face) {
  EdgeSet edges;
  for (int e = 0; e < 6; ++e)
    if (edge_to_corner[at(e)][0] != face && edge_to_corner[at(e)][1] != face) edges.insert(e);
  return edges;
}

std::set<GlobalId> nodes_on_face(const Piece& piece, const Middles& middle, std::size_t face) {
  std::set<GlobalId> nodes;
  for (std::size_t i = 0; i < 4; ++i)
    if (i != face) nodes.insert(piece.corner[i]);
  for (const int e : edges_of_face(static_cast<int>(face)))
    if (const auto found = middle.find(piece.edge(e)); found != middle.end()) nodes.insert(found->second);
  return nodes;
}

std::vector<Piece> split_as(const Piece& parent, const Middles& middle, const ReferencePattern& pattern) {
  if (pattern.marks.empty()) return {parent};
  std::vector<Piece> children;
  for (const auto& codes : pattern.child) {
    Piece child;
    for (std::size_t slot = 0; slot < 4; ++slot)
      child.corner[slot] = codes[slot] < 4 ? parent.corner[at(codes[slot])] : middle.at(parent.edge(codes[slot] - 4));
    // a cell of a family that is split by itself is a root: it knows no ancestors
    child.lineage = parent.lineage.base_for_split().closed(state_of(pattern), static_cast<int>(children.size()));
    child.row = parent.row;
    children.push_back(child);
  }
  inherit_patches(parent, middle, children);
  return children;
}

std::vector<Piece> split_in_eight(const Piece& parent, const Middles& middle, const Points& point, bool only_positive) {
  std::array<GlobalId, 6> m{};
  for (int e = 0; e < 6; ++e) m[at(e)] = middle.at(parent.edge(e));
  std::vector<Piece> children;
  const auto add = [&](const Quad& corner) {
    const auto number = static_cast<int>(children.size());
    children.push_back({corner, {-1, -1, -1, -1}, parent.lineage.base_for_split().red_child(number), parent.row});
  };
  for (std::size_t kept = 0; kept < 4; ++kept) {
    Quad corner{};
    for (std::size_t slot = 0; slot < 4; ++slot)
      corner[slot] =
          slot == kept ? parent.corner[kept] : middle.at(edge_between(parent.corner[kept], parent.corner[slot]));
    add(corner);
  }
  for (const auto& corner : cells_round_diagonal(m, choose_diagonal(m, point, only_positive))) add(corner);
  inherit_patches(parent, middle, children);
  return children;
}

std::vector<Piece> split_by_templates(const Piece& parent, const Middles& middle, const Points& point,
                                      bool only_positive) {
  const auto edges = edges_within(parent, middle);
  if (edges == all_six) return split_in_eight(parent, middle, point, only_positive);
  for (int state = 0; state <= 10; ++state)
    if (family_patterns()[at(state)].marks == edges) return split_as(parent, middle, family_patterns()[at(state)]);
  throw std::logic_error("split: the split edges of a cell are not a legal set");
}

LoneCell halve(const geometry::TetPoints& corner, EdgeSet edges) {
  LoneCell cell;
  cell.point.assign(corner.begin(), corner.end());
  for (const int e : edges) {
    const auto [a, b] = edge_to_corner[at(e)];
    cell.middle[edge_between(a, b)] = static_cast<GlobalId>(cell.point.size());
    cell.point.push_back(geometry::midpoint(corner[at(a)], corner[at(b)]));
  }
  return cell;
}

double worst_mean_ratio(const std::vector<Piece>& pieces, const Points& point) {
  double worst = 1;
  for (const auto& piece : pieces) worst = std::min(worst, geometry::mean_ratio(points_of(piece, point)));
  return worst;
}

bool all_positive(const std::vector<Piece>& pieces, const Points& point) {
  return std::all_of(pieces.begin(), pieces.end(), [&](const Piece& p) { return is_positive(p.corner, point); });
}

}  // namespace pamr::test
