// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/refine/policy.hpp"

#include <algorithm>

#include "pamr/base/index.hpp"
#include "pamr/refine/cell_shape.hpp"
#include "pamr/refine/diagonal.hpp"

namespace pamr::refine {

namespace {

/// A half of a parent's edge: from one of its ends to its midpoint. The mark of lengths plays no part.
bool is_short(mesh::Lineage lineage, int edge) {
  const auto& code = split_pattern[at(lineage.state())].child_to_node[at(lineage.child())];
  const int a = code[at(mesh::tet::edge_to_corner[at(edge)][0])], b = code[at(mesh::tet::edge_to_corner[at(edge)][1])];
  if ((a < 4) == (b < 4)) return false;
  const auto [p, q] = mesh::tet::edge_to_corner[at(std::max(a, b) - 4)];
  return p == std::min(a, b) || q == std::min(a, b);
}

double worst_of_face_split(const SplitPoints& points, int face) {
  double worst = 1;
  for (int child = 0; child < 4; ++child)
    worst = std::min(worst, geometry::mean_ratio(child_points(points, 7 + face, child)));
  return worst;
}

CellShape shape_of(const mesh::DistMesh& mesh, const mesh::Level0View& level0, LocalId cell) {
  return level0.is_empty() ? CellShape(mesh.points(cell)) : CellShape(level0, base_corners(mesh, level0, cell));
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

EdgeMask required_marks(const mesh::DistMesh& mesh, const mesh::Level0View& level0, LocalId cell, EdgeMask marks,
                        const Options& options) {
  if (marks == 0 || marks == all_edges) return marks;
  const bool is_closure = mesh.lineage[at(cell)].is_closure();
  if (options.quality_control == QualityControl::removable)  // a closure cell here has lost its parent: no floor
    return is_closure ? marks : shape_of(mesh, level0, cell).closed_marks(marks, options.shape_floor);
  if (is_closure) {
    if (options.quality_control == QualityControl::isotropic) return all_edges;
    if (options.quality_control == QualityControl::short_edge) {
      unsigned grown = marks;
      for (int e = 0; e < 6; ++e)
        if ((marks >> e & 1) != 0) grown |= face_implied_by_short_edge(mesh, cell, e);
      // marks that a template adds may be short edges too: settle again until nothing is added
      const auto legal = template_mask[grown];
      return legal == marks ? legal : required_marks(mesh, level0, cell, legal, options);
    }
  }
  return template_mask[marks];
}

SplitState state_of_cell(const mesh::DistMesh& mesh, const mesh::Level0View& level0, LocalId cell, EdgeMask marks,
                         const Options& options) {
  if (marks == 0) return 0;
  if (marks == all_edges) return regular_state;
  if (options.quality_control != QualityControl::removable) return static_cast<SplitState>(state_of_template[marks]);
  if (const int only = only_state(marks); only != 0) return static_cast<SplitState>(only);
  return static_cast<SplitState>(shape_of(mesh, level0, cell).best_state(marks));
}

}  // namespace pamr::refine
