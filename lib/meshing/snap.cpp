// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/snap.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

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

/// The cells at each node: those of node i are `cell[offset[i] .. offset[i+1])`, ascending.
struct NodeToCell {
  std::vector<std::size_t> offset, cell;

  explicit NodeToCell(const RawMesh& mesh) : offset(mesh.point.size() + 1, 0) {
    for (const auto& c : mesh.cell)
      for (const auto n : c) ++offset[static_cast<std::size_t>(n) + 1];
    for (std::size_t i = 1; i < offset.size(); ++i) offset[i] += offset[i - 1];
    cell.resize(offset.back());
    auto at = offset;
    for (std::size_t c = 0; c < mesh.cell.size(); ++c)
      for (const auto n : mesh.cell[c]) cell[at[static_cast<std::size_t>(n)]++] = c;
  }
};

class Optimizer {
 public:
  Optimizer(const Domain& domain, RawMesh& mesh) : domain_(domain), mesh_(mesh), cells_(mesh) {
    for (std::size_t c = 0; c < mesh.cell.size(); ++c) quality_.push_back(geometry::mean_ratio(mesh.points(c)));
  }

  double worst() const { return *std::min_element(quality_.begin(), quality_.end()); }

  /// Passes over the nodes of all cells below `wanted`, until nothing moves; the number of moves.
  int sweeps(double wanted, int most, bool with_boundary) {
    int moves = 0;
    for (int i = 0; i < most && worst() < wanted; ++i) {
      const int moved = sweep(wanted, with_boundary);
      moves += moved;
      if (moved == 0) break;
    }
    return moves;
  }

 private:
  int sweep(double wanted, bool with_boundary) {
    int moves = 0;
    std::vector<char> is_bad(mesh_.point.size(), 0);
    for (std::size_t c = 0; c < mesh_.cell.size(); ++c)
      if (quality_[c] < wanted)
        for (const auto n : mesh_.cell[c]) is_bad[static_cast<std::size_t>(n)] = 1;
    for (std::size_t n = 0; n < mesh_.point.size(); ++n) {
      const auto freedom = mesh_.binding[n].freedom;
      const bool may_move = freedom == Freedom::space || (with_boundary && freedom != Freedom::none);
      if (is_bad[n] != 0 && may_move && move(n)) ++moves;
    }
    return moves;
  }

  double worst_at(std::size_t node) const {
    double worst = std::numeric_limits<double>::infinity();
    for (auto i = cells_.offset[node]; i < cells_.offset[node + 1]; ++i)
      worst = std::min(worst, geometry::mean_ratio(mesh_.points(cells_.cell[i])));
    return worst;
  }

  /// Distance to the nearest neighbor.
  double length_at(std::size_t node) const {
    double shortest = std::numeric_limits<double>::infinity();
    for (auto i = cells_.offset[node]; i < cells_.offset[node + 1]; ++i)
      for (const auto other : mesh_.cell[cells_.cell[i]])
        if (static_cast<std::size_t>(other) != node)
          shortest = std::min(shortest, norm(mesh_.position(other) - mesh_.point[node]));
    return shortest;
  }

  /// Largest ratio of an edge between this boundary node and another one to the length wanted in its middle.
  double stretch_at(std::size_t node) const {
    double worst = 0;
    for (auto i = cells_.offset[node]; i < cells_.offset[node + 1]; ++i)
      for (const auto other : mesh_.cell[cells_.cell[i]]) {
        if (mesh_.binding[static_cast<std::size_t>(other)].freedom == Freedom::space) continue;
        const Vec3 p = mesh_.point[node], q = mesh_.position(other);
        worst = std::max(worst, norm(q - p) / domain_.size(midpoint(p, q)));
      }
    return worst;
  }

  bool move(std::size_t node) {
    const Vec3 start = mesh_.point[node];
    const double length = length_at(node);
    const bool is_on_boundary = mesh_.binding[node].freedom != Freedom::space;
    const double longest = is_on_boundary ? std::max(max_stretch, stretch_at(node)) : 0;
    double best = worst_at(node);
    Vec3 best_point = start;
    for (double step = 0.2; step > 0.01; step *= 0.5) {
      const Vec3 center = best_point;
      for (int direction = 0; direction < 27; ++direction) {
        const int x = direction % 3, y = direction / 3 % 3, z = direction / 9;
        const Vec3 d{x - 1.0, y - 1.0, z - 1.0};
        if (direction == 13) continue;
        mesh_.point[node] = bound(domain_, mesh_.binding[node], center + step * length / norm(d) * d);
        const double quality = worst_at(node);
        if (quality > best && (!is_on_boundary || stretch_at(node) <= longest)) {
          best = quality;
          best_point = mesh_.point[node];
        }
      }
    }
    mesh_.point[node] = best_point;
    if (best_point == start) return false;
    for (auto i = cells_.offset[node]; i < cells_.offset[node + 1]; ++i)
      quality_[cells_.cell[i]] = geometry::mean_ratio(mesh_.points(cells_.cell[i]));
    return true;
  }

  const Domain& domain_;
  RawMesh& mesh_;
  NodeToCell cells_;
  std::vector<double> quality_;
};

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
  Optimizer optimizer(domain, mesh);
  Improvement result;
  result.min_before = optimizer.worst();
  result.moves = optimizer.sweeps(goal.wanted, goal.max_sweeps, false);
  result.moves += optimizer.sweeps(goal.wanted, goal.max_sweeps, true);
  result.min_after = optimizer.worst();
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
