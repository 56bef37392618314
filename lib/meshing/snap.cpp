// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/snap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <vector>

#include "meshing/improve_node.hpp"
#include "pamr/base/error.hpp"
#include "pamr/geometry/orientation.hpp"
#include "pamr/geometry/tet_shape.hpp"

namespace pamr::meshing {
namespace {

using geometry::Vec3;

/// The exact place of a node that wants to be at `p`.
Vec3 bound(const Domain& domain, Binding binding, Vec3 p) {
  const auto number = static_cast<std::size_t>(std::max(0, binding.number));
  if (binding.freedom == Freedom::piece) return domain.pieces[number].nearest(p);
  if (binding.freedom == Freedom::curve) return domain.curves[number].nearest(p);
  return p;
}

/// Edges between boundary nodes may get as long as this times the wanted length; longer ones must not get longer.
constexpr double max_stretch = 1.15;

/// Largest ratio of an edge between a boundary node and another one to the length wanted in its middle.
double stretch_at(const Domain& domain, const RawMesh& mesh, const Stars& stars, std::size_t node) {
  double worst = 0;
  for (const auto c : stars.at_node(node))
    for (const auto other : mesh.cell[c]) {
      if (mesh.binding[static_cast<std::size_t>(other)].freedom == Freedom::space) continue;
      const Vec3 p = mesh.point[node], q = mesh.position(other);
      worst = std::max(worst, norm(q - p) / domain.size(midpoint(p, q)));
    }
  return worst;
}

/// Moves a node to where its worst cell is best. True if it moved.
bool move(const Domain& domain, const RawMesh& mesh, const Stars& stars, std::size_t node) {
  const auto binding = mesh.binding[node];
  const bool is_on_boundary = binding.freedom != Freedom::space;
  const double longest = is_on_boundary ? std::max(max_stretch, stretch_at(domain, mesh, stars, node)) : 0;
  return improve_node(
      stars, node, worst_ratio(stars, node, refused), [&](Vec3 p) { return bound(domain, binding, p); },
      [&](double ratio) {
        return is_on_boundary && stretch_at(domain, mesh, stars, node) > longest ? refused : ratio;
      });
}

/// A pass over the nodes of all cells below `wanted`, whose mean ratios `quality` holds; the number of moves.
int sweep(const Domain& domain, const RawMesh& mesh, const Stars& stars, double wanted, bool with_boundary,
          std::vector<double>& quality) {
  int moves = 0;
  std::vector<char> is_bad(mesh.point.size(), 0);
  for (std::size_t c = 0; c < mesh.cell.size(); ++c)
    if (quality[c] < wanted)
      for (const auto n : mesh.cell[c]) is_bad[static_cast<std::size_t>(n)] = 1;
  for (std::size_t n = 0; n < mesh.point.size(); ++n) {
    const auto freedom = mesh.binding[n].freedom;
    const bool may_move = freedom == Freedom::space || (with_boundary && freedom != Freedom::none);
    if (is_bad[n] == 0 || !may_move || !move(domain, mesh, stars, n)) continue;
    ++moves;
    for (const auto c : stars.at_node(n)) quality[c] = geometry::mean_ratio(mesh.points(c));
  }
  return moves;
}

double min_of(const std::vector<double>& quality) { return *std::min_element(quality.begin(), quality.end()); }

}  // namespace

double place_boundary(const Domain& domain, RawMesh& mesh) {
  double farthest = 0;
  for (std::size_t n = 0; n < mesh.point.size(); ++n) {
    const Vec3 there = bound(domain, mesh.binding[n], mesh.point[n]);
    farthest = std::max(farthest, norm(there - mesh.point[n]));
    mesh.point[n] = there;
  }
  return farthest;
}

Improvement improve(const Domain& domain, RawMesh& mesh, const QualityGoal& goal) {
  const Stars stars(mesh.point, mesh.cell);
  std::vector<double> ratio;
  for (std::size_t c = 0; c < mesh.cell.size(); ++c) ratio.push_back(geometry::mean_ratio(mesh.points(c)));
  Improvement result;
  result.min_before = min_of(ratio);
  for (const bool with_boundary : {false, true})
    for (int i = 0; i < goal.max_sweeps && min_of(ratio) < goal.wanted; ++i) {
      const int moved = sweep(domain, mesh, stars, goal.wanted, with_boundary, ratio);
      result.moves += moved;
      if (moved == 0) break;
    }
  result.min_after = min_of(ratio);
  for (std::size_t c = 0; c < mesh.cell.size(); ++c) {
    const auto p = mesh.points(c);
    const double quality = geometry::mean_ratio(p);
    if (quality >= goal.required && geometry::is_positive(p[0], p[1], p[2], p[3])) continue;
    throw Error(
        fmt::format("expected cells of mean ratio {:g} or more, found {:g} at ({:g}, {:g}, {:g}): choose finer "
                    "or more even sizes",
                    goal.required, quality, p[0].x, p[0].y, p[0].z));
  }
  return result;
}

}  // namespace pamr::meshing
