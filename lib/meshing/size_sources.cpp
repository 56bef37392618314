// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/size_sources.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace pamr::meshing {
namespace {

using geometry::Vec3;

constexpr int leaf = 8;  // sources

}  // namespace

SizeSources::SizeSources(std::vector<Source> sources, double growth) : source_(std::move(sources)), growth_(growth) {
  if (!source_.empty()) build(0, static_cast<int>(source_.size()));
}

int SizeSources::build(int begin, int end) {
  const auto first = source_.begin() + begin, last = source_.begin() + end;
  Node node{{}, first->size, begin, end, -1};
  for (auto s = first; s != last; ++s) {
    node.least = std::min(node.least, s->size);
    node.box.extend(s->point);
  }
  const auto number = node_.size();
  node_.push_back(node);
  if (end - begin <= leaf) return static_cast<int>(number);
  const auto size = node.box.size();
  std::size_t widest = 0;
  for (std::size_t k = 1; k < 3; ++k)
    if (size[k] > size[widest]) widest = k;
  const int middle = begin + (end - begin) / 2;
  std::nth_element(first, source_.begin() + middle, last,
                   [widest](const Source& a, const Source& b) { return a.point[widest] < b.point[widest]; });
  build(begin, middle);
  const int right = build(middle, end);
  node_[number].right = right;
  return static_cast<int>(number);
}

double SizeSources::grown(double size, double distance) const {
  return size + growth_ * std::max(0.0, distance - size);
}

void SizeSources::search(int number, Vec3 point, double& best) const {
  const auto& node = node_[static_cast<std::size_t>(number)];
  if (grown(node.least, std::sqrt(node.box.squared_distance(point))) >= best) return;
  if (node.right >= 0) {
    search(number + 1, point, best);
    search(node.right, point, best);
    return;
  }
  for (int i = node.begin; i < node.end; ++i) {
    const auto& source = source_[static_cast<std::size_t>(i)];
    best = std::min(best, grown(source.size, norm(point - source.point)));
  }
}

double SizeSources::at(Vec3 point, double limit) const {
  if (!node_.empty()) search(0, point, limit);
  return limit;
}

double curvature(const geometry::SurfaceJet& s) {
  const Vec3 normal = cross(s.u, s.v);
  const double length = norm(normal);
  const double ee = dot(s.u, s.u), ff = dot(s.u, s.v), gg = dot(s.v, s.v), area = ee * gg - ff * ff;
  if (!(length > 0) || !(area > 1e-12 * ee * gg)) return -1;
  const Vec3 n = 1 / length * normal;
  const double l = dot(s.uu, n), m = dot(s.uv, n), k = dot(s.vv, n);
  const double mean = (l * gg - 2 * m * ff + k * ee) / (2 * area), gauss = (l * k - m * m) / area;
  return std::abs(mean) + std::sqrt(std::max(0.0, mean * mean - gauss));
}

std::vector<SizeSources::Source> curvature_sizes(const geometry::CadModel& model, double factor, double least,
                                                 double most) {
  std::vector<SizeSources::Source> result;
  for (const auto& face : model.faces()) {
    if (face.data().is_plane) continue;
    for (std::size_t i = 0; i < face.points().size(); ++i) {
      const double bend = curvature(face.data().surface->at(face.data().sample[i]));
      if (!(bend * most > factor)) continue;
      result.push_back({face.points()[i], std::max(least, factor / bend)});
    }
  }
  return result;
}

}  // namespace pamr::meshing
