// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/closed_triangles.hpp"

#include <cmath>
#include <map>
#include <utility>

#include "pamr/base/index.hpp"

namespace pamr::meshing {

using geometry::Vec3;

ClosedTriangles::ClosedTriangles(std::span<const Vec3> point, std::span<const std::array<int, 3>> corner) {
  std::vector<int> number(point.size(), -1);
  std::vector<std::array<Vec3, 3>> soup;
  for (auto nodes : corner) {
    for (auto& node : nodes) {
      auto& known = number[at(node)];
      if (known < 0) {
        known = static_cast<int>(point_.size());
        point_.push_back(point[at(node)]);
      }
      node = known;
    }
    corner_.push_back(nodes);
    soup.push_back({point_[at(nodes[0])], point_[at(nodes[1])], point_[at(nodes[2])]});
  }
  box_ = geometry::box_of(point_);
  add_normals();
  tree_ = std::make_unique<const geometry::TriangleTree>(soup);
}

void ClosedTriangles::add_normals() {
  vertex_normal_.resize(point_.size());
  side_normal_.resize(corner_.size());
  std::map<std::pair<int, int>, std::size_t> side;  // directed, with 3 t + the corner opposite
  for (std::size_t t = 0; t < corner_.size(); ++t) {
    const auto p = [&](std::size_t k) { return point_[at(corner_[t][k % 3])]; };
    const Vec3 n = cross(p(1) - p(0), p(2) - p(0));
    const double length = norm(n);
    normal_.push_back(length > 0 ? 1 / length * n : n);
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 a = p(k + 1) - p(k), b = p(k + 2) - p(k);
      auto& sum = vertex_normal_[at(corner_[t][k])];
      sum = sum + std::atan2(norm(cross(a, b)), dot(a, b)) * normal_.back();
      side.try_emplace({corner_[t][(k + 1) % 3], corner_[t][(k + 2) % 3]}, 3 * t + k);
    }
  }
  n_open_ = static_cast<std::int64_t>(3 * corner_.size() - side.size());  // two with one direction
  std::size_t first = 0;
  for (const auto& [ends, place] : side) {
    const auto other = side.find({ends.second, ends.first});
    if (other == side.end()) {
      if (n_open_++ == 0) first = place;
      continue;
    }
    side_normal_[place / 3][place % 3] = normal_[place / 3] + normal_[other->second / 3];
  }
  if (n_open_ == 0) return;
  open_triangle_ = static_cast<int>(first / 3);
  open_point_ = point_[at(corner_[first / 3][(first + 1) % 3])];
}

double ClosedTriangles::signed_distance(Vec3 point) const {
  const auto hit = tree_->nearest(point);
  const auto t = at(hit.triangle);
  const Vec3 a = point_[at(corner_[t][0])], b = point_[at(corner_[t][1])], c = point_[at(corner_[t][2])];
  constexpr double rounding = 1e-12;
  const std::array<double, 3> weight{1 - hit.u - hit.v, hit.u, hit.v};
  const auto is_zero = [&](std::size_t k) { return weight[k] < rounding; };
  const auto n_zero = is_zero(0) + is_zero(1) + is_zero(2);
  Vec3 outward = normal_[t];
  if (n_zero == 1) outward = side_normal_[t][is_zero(0) ? 0 : is_zero(1) ? 1 : 2];
  if (n_zero == 2) outward = vertex_normal_[at(corner_[t][!is_zero(0) ? 0 : !is_zero(1) ? 1 : 2])];
  const Vec3 from_foot = point - (weight[0] * a + weight[1] * b + weight[2] * c);
  const double distance = norm(from_foot);
  return dot(from_foot, outward) < 0 ? -distance : distance;
}

}  // namespace pamr::meshing
