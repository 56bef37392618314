// SPDX-License-Identifier: GPL-3.0-or-later
// The policies `none`, `isotropic` and `short-edge`.
#include <algorithm>

#include "support/reference_close.hpp"

namespace pamr::test {

namespace {

using mesh::tet::edge_to_corner;
using refine::QualityControl;

std::size_t at(std::int64_t i) { return static_cast<std::size_t>(i); }

/// The smallest legal set that holds the given edges: two on a face become three, anything else six.
EdgeSet make_legal(EdgeSet edges) {
  if (edges.size() <= 1) return edges;
  for (int face = 0; face < 4; ++face) {
    const auto whole = edges_of_face(face);
    if (std::includes(whole.begin(), whole.end(), edges.begin(), edges.end())) return whole;
  }
  return all_six;
}

/// Half of an edge of the parent: joins a corner of it with the middle of an edge there.
bool is_short(mesh::Lineage lineage, int edge) {
  const auto& codes = family_patterns()[at(lineage.state())].child[at(lineage.child())];
  const auto [i, j] = edge_to_corner[at(edge)];
  const auto joins = [](Code corner, Code middle) {
    return corner < 4 && middle >= 4 &&
           (edge_to_corner[at(middle - 4)][0] == corner || edge_to_corner[at(middle - 4)][1] == corner);
  };
  const Code a = codes[at(i)], b = codes[at(j)];
  return joins(a, b) || joins(b, a);
}

double worst_child_if_halved(const geometry::TetPoints& corner, EdgeSet edges) {
  const auto cell = halve(corner, edges);
  return worst_mean_ratio(split_by_templates(cell.piece, cell.middle, cell.point, false), cell.point);
}

/// Of the two faces at an edge the one whose four children have the larger smallest mean ratio; among equals the one
/// whose third corner comes first.
EdgeSet better_face(const geometry::TetPoints& corner, int edge) {
  const auto [p, q] = edge_to_corner[at(5 - edge)];
  const double p_worst = worst_child_if_halved(corner, edges_of_face(p));
  const double q_worst = worst_child_if_halved(corner, edges_of_face(q));
  const bool tied = p_worst <= q_worst * rounding && q_worst <= p_worst * rounding;
  // q is the third corner of the face opposite p
  const bool take_p = tied ? geometry::lexicographically_less(corner[at(q)], corner[at(p)]) : p_worst > q_worst;
  return edges_of_face(take_p ? p : q);
}

EdgeSet required(const Piece& piece, EdgeSet edges, const Points& point, QualityControl policy) {
  if (edges.empty()) return edges;
  if (piece.lineage.is_closure() && policy == QualityControl::isotropic) return all_six;
  if (piece.lineage.is_closure() && policy == QualityControl::short_edge)
    for (const int e : EdgeSet(edges))
      if (is_short(piece.lineage, e)) edges.merge(better_face(points_of(piece, point), e));
  return make_legal(edges);
}

}  // namespace

ReferenceClosing close_by_templates(const std::vector<Piece>& cell, const Points& point,
                                    const std::vector<std::uint8_t>& flags, QualityControl policy) {
  ReferenceClosing closing;
  closing.point = point;
  const auto mark = [&](const Edge& edge) {
    if (!closing.marked.insert(edge).second) return;
    closing.middle[edge] = static_cast<GlobalId>(closing.point.size());
    closing.point.push_back(geometry::midpoint(point[at(edge.first)], point[at(edge.second)]));
  };
  for (std::size_t c = 0; c < cell.size(); ++c)
    for (int e = 0; e < 6 && flags[c] != 0; ++e) mark(cell[c].edge(e));
  for (std::size_t before = closing.marked.size() + 1; before != closing.marked.size();) {
    before = closing.marked.size();
    for (const auto& piece : cell)
      for (const int e : required(piece, edges_within(piece, closing.marked), point, policy)) mark(piece.edge(e));
  }
  for (std::size_t c = 0; c < cell.size(); ++c)
    if (edges_within(cell[c], closing.marked) != all_six)
      closing.children[static_cast<GlobalId>(c)] = split_by_templates(cell[c], closing.middle, point, false);
  return closing;
}

}  // namespace pamr::test
