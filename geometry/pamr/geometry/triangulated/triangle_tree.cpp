// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/triangle_tree.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"

namespace pamr::geometry {

namespace {

constexpr std::size_t leaf_size = 3;
constexpr std::size_t max_parts = 16;  ///< of a triangle, on average
constexpr int max_halvings = 8;
constexpr double thin = 12;      ///< squared diagonal of the box by the area: such triangles have shorter parts
constexpr double long_part = 3;  ///< diagonal of a part's box, in sides of a square of the mean area

/// The longest diagonal that the box of a part may have; none where no triangle has an area.
double longest_diagonal(std::span<const std::array<Vec3, 3>> triangles) {
  double area = 0;
  for (const auto& t : triangles) area += 0.5 * norm(cross(t[1] - t[0], t[2] - t[0]));
  const double longest = long_part * std::sqrt(area / static_cast<double>(triangles.size()));
  return longest > 0 ? longest : std::numeric_limits<double>::infinity();
}

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
  for (const auto& item : items) box.merge(item.box);
  return box;
}

/// Halves the longest side until the box is short enough, or so many times. The boxes of parts are a little larger than these, so that no
/// point of the triangle is in none by rounding.
void TriangleTree::add_parts(const Item& whole, const std::array<Vec3, 3>& part, double longest, int n_halvings,
                             std::vector<Item>& items) {
  auto box = box_of(part);
  if (box.diagonal() <= longest || n_halvings == 0) {
    constexpr double rounding = 1e-14;
    const double pad = rounding * (norm(box.low) + norm(box.high));
    box.merge({box.low - Vec3{pad, pad, pad}, box.high + Vec3{pad, pad, pad}});
    items.push_back({whole.corner, box, (1.0 / 3) * (part[0] + part[1] + part[2]), whole.triangle});
    return;
  }
  std::size_t k = 0;
  for (std::size_t i = 1; i < 3; ++i)
    if (squared_norm(part[(i + 2) % 3] - part[(i + 1) % 3]) > squared_norm(part[(k + 2) % 3] - part[(k + 1) % 3]))
      k = i;
  const Vec3 top = part[k], a = part[(k + 1) % 3], b = part[(k + 2) % 3], middle = midpoint(a, b);
  add_parts(whole, {top, a, middle}, longest, n_halvings - 1, items);
  add_parts(whole, {top, middle, b}, longest, n_halvings - 1, items);
}

TriangleTree::TriangleTree(std::span<const std::array<Vec3, 3>> triangles) {
  std::vector<Item> items;
  const double longest = triangles.empty() ? 0 : longest_diagonal(triangles);
  items.reserve(triangles.size());
  int number = 0;
  for (const auto& t : triangles) {
    const Item whole{t, box_of(t), (1.0 / 3) * (t[0] + t[1] + t[2]), number++};
    const double diagonal = whole.box.diagonal(), area = 0.5 * norm(cross(t[1] - t[0], t[2] - t[0]));
    const double part = diagonal * diagonal > thin * area ? longest / long_part : longest;
    if (diagonal > part && items.size() < max_parts * triangles.size())
      add_parts(whole, t, part, max_halvings, items);
    else
      items.push_back(whole);
  }
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
  const Vec3 size = box_of_items(items).size();
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
