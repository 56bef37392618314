// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/triangle_tree.hpp"

#include <algorithm>
#include <limits>

#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"

namespace pamr::geometry {

namespace {

constexpr std::size_t leaf_size = 3;

}  // namespace

std::array<double, 2> nearest_parameters(Vec3 ab, Vec3 ac, Vec3 ap) {
  const double d1 = dot(ab, ap), d2 = dot(ac, ap);
  if (d1 <= 0 && d2 <= 0) return {0, 0};
  const double abab = dot(ab, ab), abac = dot(ab, ac), acac = dot(ac, ac);
  const double d3 = d1 - abab, d4 = d2 - abac;
  if (d3 >= 0 && d4 <= d3) return {1, 0};
  const double vc = d1 * d4 - d3 * d2;
  if (vc <= 0 && d1 >= 0 && d3 <= 0) return {d1 / abab, 0};
  const double d5 = d1 - abac, d6 = d2 - acac;
  if (d6 >= 0 && d5 <= d6) return {0, 1};
  const double vb = d5 * d2 - d1 * d6;
  if (vb <= 0 && d2 >= 0 && d6 <= 0) return {0, d2 / acac};
  const double va = d3 * d6 - d5 * d4;
  if (va <= 0 && d4 - d3 >= 0 && d5 - d6 >= 0) {
    const double w = (d4 - d3) / ((d4 - d3) + (d5 - d6));
    return {1 - w, w};
  }
  if (!(va + vb + vc > 0)) return {0, 0};  // rounding in a sliver
  const double scale = 1 / (va + vb + vc);
  return {vb * scale, vc * scale};
}

Box TriangleTree::box_of_items(std::span<const Item> items) {
  Box box;
  for (const auto& item : items) box.merge(box_of(item.corner));
  return box;
}

TriangleTree::TriangleTree(std::span<const std::array<Vec3, 3>> triangles) {
  std::vector<Item> items;
  items.reserve(triangles.size());
  for (const auto& t : triangles)
    items.push_back({t, (1.0 / 3) * (t[0] + t[1] + t[2]), static_cast<int>(items.size())});
  nodes_.reserve(items.size());
  entries_.reserve(items.size());
  if (items.empty()) return;
  build(items, 0);
  for (const auto& item : items)
    entries_.push_back(
        {item.corner[0], item.corner[1] - item.corner[0], item.corner[2] - item.corner[0], item.triangle});
}

int TriangleTree::build(std::span<Item> items, std::size_t first) {
  const auto number = static_cast<int>(nodes_.size());
  nodes_.emplace_back();
  Box centers;
  for (const auto& item : items) centers.extend(item.center);
  const Vec3 size = centers.size();
  const auto key = [&](const Item& item) {
    if (size.x >= size.y && size.x >= size.z) return item.center.x;
    return size.y >= size.z ? item.center.y : item.center.z;
  };
  const auto half = items.size() / 2;
  std::nth_element(
      items.begin(), items.begin() + static_cast<std::ptrdiff_t>(half), items.end(),
      [&](const Item& a, const Item& b) { return key(a) != key(b) ? key(a) < key(b) : a.triangle < b.triangle; });
  const std::array<std::span<Item>, 2> parts{items.first(half), items.subspan(half)};
  for (std::size_t side = 0; side < 2; ++side) {
    const auto start = first + side * half;
    const bool is_leaf = parts[side].size() <= leaf_size;
    const int child = is_leaf ? -1 - static_cast<int>(start) : build(parts[side], start);
    auto& node = nodes_[at(number)];
    node.box[side] = box_of_items(parts[side]);
    node.child[side] = child;
    node.count[side] = is_leaf ? static_cast<int>(parts[side].size()) : 0;
  }
  return number;
}

TriangleTree::Hit TriangleTree::nearest(Vec3 point, double distance_limit) const {
  struct Waiting {
    int child, count;
    double distance;
  };
  std::array<Waiting, 96> stack;  // the tree is balanced: 2 for each of at most 32 levels
  std::size_t n_waiting = 0;
  Hit best;
  double least = distance_limit * distance_limit;
  if (!nodes_.empty()) stack[n_waiting++] = {0, 0, 0};
  while (n_waiting > 0) {
    const Waiting next = stack[--n_waiting];
    if (next.distance > least) continue;
    if (next.child >= 0) {
      const Node& node = nodes_[at(next.child)];
      const double d0 = node.box[0].squared_distance(point), d1 = node.box[1].squared_distance(point);
      const std::size_t near = d1 < d0 ? 1 : 0;
      const double far_distance = near == 1 ? d0 : d1, near_distance = near == 1 ? d1 : d0;
      if (far_distance <= least) stack[n_waiting++] = {node.child[1 - near], node.count[1 - near], far_distance};
      if (near_distance <= least) stack[n_waiting++] = {node.child[near], node.count[near], near_distance};
      continue;
    }
    for (int i = 0; i < next.count; ++i) {
      const Entry& entry = entries_[at(-1 - next.child + i)];
      const Vec3 ap = point - entry.a;
      const auto [u, v] = nearest_parameters(entry.ab, entry.ac, ap);
      const double distance = squared_norm(ap - u * entry.ab - v * entry.ac);
      if (distance < least || (distance == least && (best.triangle < 0 || entry.triangle < best.triangle))) {
        least = distance;
        best = {entry.triangle, u, v};
      }
    }
  }
  return best;
}

}  // namespace pamr::geometry
