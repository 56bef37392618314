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

/// Two numbers within this factor are equal to rounding.
constexpr double rounding = 1 + 0x1p-40;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

mesh::Lineage child_lineage(const Piece& parent, mesh::FamilyKind kind, int index, int child) {
  const int level = parent.lineage.level();
  return {kind, index, child, kind == mesh::FamilyKind::regular ? level + 1 : level};
}

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
      if (std::set<int>{e, g, diagonal, 5 - diagonal}.size() != 4 || e + g == 5) continue;
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

std::vector<Piece> split_in_two(const Piece& parent, const Middles& middle, int edge) {
  const auto m = middle.at(parent.edge(edge));
  const auto [i, j] = edge_to_corner[at(edge)];
  std::vector<Piece> children(2);
  children[0].corner = parent.with(at(j), m);
  children[1].corner = parent.with(at(i), m);
  for (int child = 0; child < 2; ++child)
    children[at(child)].lineage = child_lineage(parent, mesh::FamilyKind::edge, edge, child);
  return children;
}

/// The three corners of the face in turn keep theirs, the two others give way to the middles towards it; the last cell
/// stands on the triangle of the middles, each in the place of the corner it is opposite to.
std::vector<Piece> split_in_four(const Piece& parent, const Middles& middle, int face) {
  const auto between = [&](int a, int b) {
    return middle.at(edge_between(parent.corner[at(a)], parent.corner[at(b)]));
  };
  std::vector<Piece> children;
  Piece central;
  central.corner[at(face)] = parent.corner[at(face)];
  for (int kept = 0; kept < 4; ++kept) {
    if (kept == face) continue;
    Piece child;
    std::vector<int> others;
    for (int slot = 0; slot < 4; ++slot) {
      const bool gives_way = slot != kept && slot != face;
      if (gives_way) others.push_back(slot);
      child.corner[at(slot)] = gives_way ? between(kept, slot) : parent.corner[at(slot)];
    }
    central.corner[at(kept)] = between(others[0], others[1]);
    children.push_back(child);
  }
  children.push_back(central);
  for (int child = 0; child < 4; ++child)
    children[at(child)].lineage = child_lineage(parent, mesh::FamilyKind::face, face, child);
  return children;
}

std::vector<Piece> split_in_eight(const Piece& parent, const Middles& middle, const Points& point, bool only_positive) {
  std::array<GlobalId, 6> m{};
  for (int e = 0; e < 6; ++e) m[at(e)] = middle.at(parent.edge(e));
  std::vector<Piece> children;
  const auto add = [&](const Quad& corner) {
    children.push_back({corner, {-1, -1, -1, -1}, child_lineage(parent, mesh::FamilyKind::regular, 0, 0)});
  };
  for (std::size_t kept = 0; kept < 4; ++kept) {
    Quad corner{};
    for (std::size_t slot = 0; slot < 4; ++slot)
      corner[slot] =
          slot == kept ? parent.corner[kept] : middle.at(edge_between(parent.corner[kept], parent.corner[slot]));
    add(corner);
  }
  for (const auto& corner : cells_round_diagonal(m, choose_diagonal(m, point, only_positive))) add(corner);
  return children;
}

/// A child's face has the patch of the parent's face in which all its nodes lie.
void inherit_patches(const Piece& parent, const Middles& middle, std::vector<Piece>& children) {
  for (auto& child : children)
    for (std::size_t slot = 0; slot < 4; ++slot)
      for (std::size_t face = 0; face < 4; ++face) {
        const auto on_face = nodes_on_face(parent, middle, face);
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

std::set<int> edges_of_face(int face) {
  std::set<int> edges;
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

std::vector<Piece> split(const Piece& parent, const Middles& middle, const Points& point, bool only_positive) {
  const auto edges = edges_within(parent, middle);
  if (edges.empty()) return {parent};
  std::vector<Piece> children;
  if (edges.size() == 1) children = split_in_two(parent, middle, *edges.begin());
  for (int face = 0; face < 4; ++face)
    if (edges == edges_of_face(face)) children = split_in_four(parent, middle, face);
  if (edges == all_six) children = split_in_eight(parent, middle, point, only_positive);
  if (children.empty()) throw std::logic_error("split: the split edges of a cell are not a legal set");
  inherit_patches(parent, middle, children);
  return children;
}

double worst_child_if_halved(const geometry::TetPoints& corner, const std::set<int>& edges) {
  Points point(corner.begin(), corner.end());
  Middles middle;
  for (const int e : edges) {
    const auto [a, b] = edge_to_corner[at(e)];
    middle[edge_between(a, b)] = static_cast<GlobalId>(point.size());
    point.push_back(geometry::midpoint(corner[at(a)], corner[at(b)]));
  }
  double worst = 1;
  for (const auto& child : split({{0, 1, 2, 3}, {-1, -1, -1, -1}, {}}, middle, point, false))
    worst = std::min(worst, geometry::mean_ratio(points_of(child, point)));
  return worst;
}

bool all_positive(const std::vector<Piece>& pieces, const Points& point) {
  return std::all_of(pieces.begin(), pieces.end(), [&](const Piece& p) { return is_positive(p.corner, point); });
}

}  // namespace pamr::test
