// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/policy.hpp"

#include <algorithm>
#include <bit>

#include "pamr/base/index.hpp"
#include "pamr/refine/diagonal.hpp"

namespace pamr::refine {

namespace {

/// A half of a parent's edge: from one of its ends to its midpoint. The mark of lengths plays no part.
bool is_short(mesh::Lineage lineage, int edge) {
  const auto& pattern = split_pattern[at(state_of_family(lineage))];
  const auto& code = pattern.child_to_node[at(lineage.child())];
  const int a = code[at(mesh::tet::edge_to_corner[at(edge)][0])], b = code[at(mesh::tet::edge_to_corner[at(edge)][1])];
  if ((a < 4) == (b < 4)) return false;
  const auto [p, q] = mesh::tet::edge_to_corner[at(std::max(a, b) - 4)];
  return p == std::min(a, b) || q == std::min(a, b);
}

SplitPoints straight_points(const geometry::TetPoints& corner) {
  SplitPoints points;
  std::copy(corner.begin(), corner.end(), points.begin());
  for (int e = 0; e < 6; ++e) {
    const auto [a, b] = mesh::tet::edge_to_corner[at(e)];
    points[at(4 + e)] = geometry::midpoint(corner[at(a)], corner[at(b)]);
  }
  return points;
}

/// The mean ratio's place on a scale without roots: its third power over 12^3 9.
double cubed(double mean_ratio) { return mean_ratio * mean_ratio * mean_ratio / 15552; }

double worst_shape(const SplitPoints& points, int state) {
  double worst = shape(child_points(points, state, 0));
  for (int child = 1; child < split_pattern[at(state)].n_children; ++child)
    worst = std::min(worst, shape(child_points(points, state, child)));
  return worst;
}

double worst_of_face_split(const SplitPoints& points, int face) {
  double worst = 1;
  for (int child = 0; child < 4; ++child)
    worst = std::min(worst, geometry::mean_ratio(child_points(points, 7 + face, child)));
  return worst;
}

}  // namespace

EdgeMask face_implied_by_short_edge(const mesh::DistMesh& mesh, LocalId cell, int edge) {
  if (!is_short(mesh.lineage[at(cell)], edge)) return 0;
  const auto corners = mesh.points(cell);
  const auto points = straight_points(corners);
  // the two faces at the edge lie opposite the two corners that are not on it
  const auto [p, q] = mesh::tet::edge_to_corner[at(mesh::tet::opposite_edge(edge))];
  const double without_p = worst_of_face_split(points, p), without_q = worst_of_face_split(points, q);
  constexpr double rounding = 1.0 + 0x1p-40;
  const bool tied = without_p <= rounding * without_q && without_q <= rounding * without_p;
  // face p has third corner q, and the reverse
  const bool take_p = tied ? geometry::lexicographically_less(corners[at(q)], corners[at(p)]) : without_p > without_q;
  return mesh::tet::face_edge_mask[at(take_p ? p : q)];
}

namespace {

/// True when closing any one of the marked edges, or the marked face, of a straight cell makes shapes of `limit` or
/// better, from its edges alone. Squared lengths: a median is (2 a^2 + 2 b^2 - c^2) / 4, with which the sums over the
/// edges of a child become sums over those of the cell. Children of 1:2 have half of the volume each, those of 1:4 a
/// quarter.
bool all_close_well(const geometry::TetPoints& corner, EdgeMask marks, double limit) {
  std::array<double, 6> squared{};
  double all = 0;
  for (std::size_t e = 0; e < 6; ++e) {
    const auto [a, b] = mesh::tet::edge_to_corner[e];
    squared[e] = geometry::squared_norm(corner[at(a)] - corner[at(b)]);
    all += squared[e];
  }
  const auto between = [&squared](int a, int b) { return squared[at(mesh::tet::edge_of[at(a)][at(b)])]; };
  double largest = 0;  // sum of squared edges of a child of 1:2
  for (unsigned rest = marks; rest != 0; rest &= rest - 1) {
    const int e = std::countr_zero(rest), opposite = mesh::tet::opposite_edge(e);
    const auto [a, b] = mesh::tet::edge_to_corner[at(e)];
    const auto [c, d] = mesh::tet::edge_to_corner[at(opposite)];
    const double longer = std::max(between(a, c) + between(a, d), between(b, c) + between(b, d));
    largest = std::max(largest, 0.5 * (all + squared[at(opposite)]) - 0.75 * squared[at(e)] + longer);
  }
  const double v = geometry::volume(corner), halved = 0.25 * v * std::abs(v);
  if (halved < limit * largest * largest * largest) return false;
  const int state = state_of_mask[marks];
  if (state < 7) return true;
  const int top = state - 7;  // face f lies opposite corner f
  double upright = 0, most = 0;
  for (int i = 0; i < 4; ++i) {
    if (i == top) continue;
    const int e = mesh::tet::edge_of[at(top)][at(i)];
    upright += squared[at(e)];
    most = std::max(most, 1.5 * squared[at(e)] + 0.25 * squared[at(mesh::tet::opposite_edge(e))]);
  }
  const double largest_quarter = std::max(upright, 0.5 * upright + most);
  return 0.25 * halved >= limit * largest_quarter * largest_quarter * largest_quarter;
}

}  // namespace

bool closes_badly(const geometry::TetPoints& corner, EdgeMask marks) {
  if (marks == 0 || marks == all_edges) return false;
  if (all_close_well(corner, marks, cubed(worst_closure) * (1 + 1e-9))) return false;
  const auto points = straight_points(corner);
  double worst = std::popcount(marks) == 3 ? worst_shape(points, state_of_mask[marks]) : 1;
  for (int e = 0; e < 6; ++e)
    if ((marks >> e & 1) != 0) worst = std::min(worst, worst_shape(points, 1 + e));
  return worst < cubed(worst_closure) && worst_shape(points, 11 + choose_diagonal(points, true)) > worst;
}

EdgeMask required_marks(const mesh::DistMesh& mesh, LocalId cell, EdgeMask marks, QualityControl policy) {
  if (marks == 0 || marks == all_edges) return marks;
  const auto lineage = mesh.lineage[at(cell)];
  if (lineage.is_closure()) {
    if (policy == QualityControl::isotropic) return all_edges;
    if (policy == QualityControl::short_edge) {
      unsigned grown = marks;
      for (int e = 0; e < 6; ++e)
        if ((marks >> e & 1) != 0) grown |= face_implied_by_short_edge(mesh, cell, e);
      // marks that legality adds may be short edges too: settle again until nothing is added
      const auto legal = legal_mask[grown];
      return legal == marks ? legal : required_marks(mesh, cell, legal, policy);
    }
  }
  const auto legal = legal_mask[marks];
  const bool is_base_cell = policy == QualityControl::removable && !lineage.is_closure();
  return is_base_cell && closes_badly(mesh.points(cell), legal) ? all_edges : legal;
}

}  // namespace pamr::refine
