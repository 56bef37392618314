// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/mesh/plane_fit.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/mesh/tet.hpp"

namespace pamr::mesh {

namespace {

using geometry::Vec3;
constexpr double infinity = std::numeric_limits<double>::infinity();

/// What coordinates of that size may be off by rounding.
double rounding_of(double largest_coordinate) {
  return 8 * (std::nextafter(largest_coordinate, infinity) - largest_coordinate);
}

/// The nodes of the patches that are looked at, without repeats.
struct PatchNodes {
  std::vector<std::size_t> patch;  ///< of each row
  std::vector<std::vector<Vec3>> point;
};

PatchNodes nodes_of(const DistMesh& mesh, const std::vector<bool>& is_wanted) {
  PatchNodes nodes;
  std::vector<std::size_t> row(is_wanted.size(), 0);
  for (std::size_t p = 0; p < is_wanted.size(); ++p)
    if (is_wanted[p]) {
      row[p] = nodes.patch.size();
      nodes.patch.push_back(p);
    }
  std::vector<std::vector<LocalId>> ids(nodes.patch.size());
  for (LocalId c = 0; c < mesh.n_cells(); ++c)
    for (int f = 0; f < 4; ++f) {
      const auto next = mesh.cell_to_cell[at(c)][at(f)];
      if (next >= 0 || at(slot_to_patch(next)) >= is_wanted.size() || !is_wanted[at(slot_to_patch(next))]) continue;
      for (const auto corner : tet::face_to_corner[at(f)])
        ids[row[at(slot_to_patch(next))]].push_back(mesh.cell_to_node[at(c)][at(corner)]);
    }
  for (auto& list : ids) {
    std::sort(list.begin(), list.end());
    list.erase(std::unique(list.begin(), list.end()), list.end());
    auto& points = nodes.point.emplace_back();
    for (const auto node : list) points.push_back(mesh.point(node));
  }
  return nodes;
}

/// For each row the largest of the values that the ranks have; -0 counts as 0, so that the bits do not depend on the
/// ranks. Collective.
std::vector<double> max_over_ranks(const par::Comm& comm, std::vector<double> values) {
  for (auto& value : values) value += 0.0;
  comm.max_in_place(values);
  return values;
}

/// For each row the node of the largest value, the last by coordinates among equals, over all ranks. `value` takes a
/// row and a point. Collective: four reductions.
template <class Value>
std::vector<Vec3> largest(const par::Comm& comm, const PatchNodes& nodes, Value&& value) {
  const auto n = nodes.patch.size();
  std::vector<std::vector<Vec3>> left = nodes.point;
  const auto narrow = [&](auto&& key) {
    std::vector<double> best(n, -infinity);
    for (std::size_t r = 0; r < n; ++r)
      for (const auto& p : left[r]) best[r] = std::max(best[r], key(r, p));
    best = max_over_ranks(comm, best);
    for (std::size_t r = 0; r < n; ++r) std::erase_if(left[r], [&](const Vec3& p) { return key(r, p) != best[r]; });
    return best;
  };
  narrow(value);
  const auto x = narrow([](std::size_t, Vec3 p) { return p.x; });
  const auto y = narrow([](std::size_t, Vec3 p) { return p.y; });
  const auto z = narrow([](std::size_t, Vec3 p) { return p.z; });
  std::vector<Vec3> result;
  for (std::size_t r = 0; r < n; ++r) result.push_back({x[r], y[r], z[r]});
  return result;
}

/// The box of each row; empty ones have infinite bounds. Collective: one reduction.
std::vector<geometry::Box> boxes_of(const par::Comm& comm, const PatchNodes& nodes) {
  std::vector<double> bound(6 * nodes.patch.size(), -infinity);
  for (std::size_t r = 0; r < nodes.patch.size(); ++r)
    for (const auto& p : nodes.point[r]) {
      const std::array<double, 6> x{p.x, p.y, p.z, -p.x, -p.y, -p.z};
      // what is not finite makes the box infinite
      for (std::size_t k = 0; k < 6; ++k)
        bound[6 * r + k] = std::isfinite(x[k]) ? std::max(bound[6 * r + k], x[k]) : infinity;
    }
  bound = max_over_ranks(comm, bound);
  std::vector<geometry::Box> boxes(nodes.patch.size());
  for (std::size_t r = 0; r < boxes.size(); ++r)
    for (std::size_t d = 0; d < 3; ++d) {
      boxes[r].high[d] = bound[6 * r + d];
      boxes[r].low[d] = -bound[6 * r + 3 + d];
    }
  return boxes;
}

/// The plane normal to the axis along which the box is thinnest; through zero if that lies within the box.
PlaneFit plane_across(const geometry::Box& box) {
  std::size_t axis = 0;
  for (std::size_t d = 1; d < 3; ++d)
    if (box.high[d] - box.low[d] < box.high[axis] - box.low[axis]) axis = d;
  const double low = box.low[axis], high = box.high[axis];
  const double middle = low <= 0 && high >= 0 ? 0.0 : low + 0.5 * (high - low);
  PlaneFit fit;
  fit.point[axis] = middle;
  fit.normal[axis] = 1;
  fit.distance = std::max(high - middle, middle - low);
  return fit;
}

/// The plane through three points; infinitely far from all where they lie on one line.
PlaneFit plane_through(Vec3 a, Vec3 b, Vec3 c) {
  PlaneFit fit;
  fit.point = a;
  fit.distance = infinity;
  const Vec3 across = cross(b - a, c - a);
  const double largest = std::max({std::abs(across.x), std::abs(across.y), std::abs(across.z)});
  if (!(largest > 0) || !std::isfinite(largest)) return fit;
  Vec3 normal = (1 / largest) * across;
  normal = (1 / norm(normal)) * normal;
  const double first = normal.x != 0 ? normal.x : normal.y != 0 ? normal.y : normal.z;
  fit.normal = (first < 0 ? -1.0 : 1.0) * normal;
  return fit;
}

/// Sets the largest distances of the nodes from the planes. Collective: one reduction.
void measure_distances(const par::Comm& comm, const PatchNodes& nodes, std::vector<PlaneFit>& fit) {
  std::vector<double> farthest(nodes.patch.size(), 0);
  for (std::size_t r = 0; r < farthest.size(); ++r)
    for (const auto& p : nodes.point[r])
      farthest[r] = std::max(farthest[r], std::abs(dot(p - fit[r].point, fit[r].normal)));
  farthest = max_over_ranks(comm, farthest);
  for (std::size_t r = 0; r < farthest.size(); ++r)
    if (fit[r].normal != Vec3{}) fit[r].distance = farthest[r];
}

/// The planes through three extreme nodes of each row. Collective: twelve reductions.
std::vector<PlaneFit> planes_through_nodes(const par::Comm& comm, const PatchNodes& nodes) {
  const auto a = largest(comm, nodes, [](std::size_t, Vec3) { return 0.0; });
  const auto b = largest(comm, nodes, [&](std::size_t r, Vec3 p) { return norm(p - a[r]); });
  const auto c = largest(comm, nodes, [&](std::size_t r, Vec3 p) { return norm(cross(p - a[r], b[r] - a[r])); });
  std::vector<PlaneFit> fit;
  for (std::size_t r = 0; r < nodes.patch.size(); ++r) fit.push_back(plane_through(a[r], b[r], c[r]));
  measure_distances(comm, nodes, fit);
  return fit;
}

}  // namespace

double flatness_tolerance(double size, double largest_coordinate) {
  return std::max(1e-10 * size, rounding_of(largest_coordinate));
}

std::vector<PlaneFit> fit_planes(const par::Comm& comm, const DistMesh& mesh, const std::vector<bool>& is_wanted) {
  std::vector<PlaneFit> result(is_wanted.size());
  if (std::find(is_wanted.begin(), is_wanted.end(), true) == is_wanted.end()) return result;
  auto nodes = nodes_of(mesh, is_wanted);
  const auto boxes = boxes_of(comm, nodes);
  const auto through_nodes = planes_through_nodes(comm, nodes);
  for (std::size_t r = 0; r < boxes.size(); ++r) {
    const auto& [low, high] = boxes[r];
    auto& fit = result[nodes.patch[r]];
    if (boxes[r].is_empty()) continue;  // no faces
    const double size = boxes[r].diagonal();
    double coordinate = 0;
    for (std::size_t d = 0; d < 3; ++d) coordinate = std::max({coordinate, std::abs(low[d]), std::abs(high[d])});
    if (!std::isfinite(size)) {
      fit.size = fit.distance = infinity;
      continue;
    }
    const double tolerance = flatness_tolerance(size, coordinate);
    fit = plane_across(boxes[r]);
    if (fit.distance > rounding_of(coordinate) && through_nodes[r].distance < fit.distance) fit = through_nodes[r];
    fit.size = size;
    fit.is_flat = fit.distance <= tolerance;
  }
  return result;
}

}  // namespace pamr::mesh
