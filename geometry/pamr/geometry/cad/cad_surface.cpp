// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/cad_surface.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"

namespace pamr::geometry {

namespace {

constexpr double near_edge = 1e-6;        // of the size, what nodes of an edge may be off it, as associating allows
constexpr double equal_distance = 1e-14;  // of the size: distances that are equal but for rounding

}  // namespace

CadSurface::CadSurface(std::shared_ptr<const CadModel> model, std::vector<int> faces)
    : model_(std::move(model)), faces_(std::move(faces)) {
  if (faces_.empty()) throw Error("faces: expected one or more, found none");
  std::sort(faces_.begin(), faces_.end());
  for (std::size_t i = 0; i < faces_.size(); ++i) {
    if (faces_[i] < 0 || at(faces_[i]) >= model_->faces().size())
      throw Error(fmt::format("faces: expected numbers from 1 to {}, found {}", model_->faces().size(), faces_[i] + 1));
    if (i > 0 && faces_[i] == faces_[i - 1])
      throw Error(fmt::format("faces: expected different ones, found {} twice", faces_[i] + 1));
  }
  for (std::size_t e = 0; e < model_->edges().size(); ++e) {
    const auto& at_edge = model_->faces_of(static_cast<int>(e));
    const auto n = std::count_if(at_edge.begin(), at_edge.end(), [this](int f) { return has(f); });
    if (n >= 1) edges_.push_back(static_cast<int>(e));
    if (n >= 2) inner_edges_.push_back(static_cast<int>(e));
  }
}

bool CadSurface::has(int face) const { return std::binary_search(faces_.begin(), faces_.end(), face); }

CadSurface::Place CadSurface::nearest(Vec3 point) const {
  if (faces_.size() == 1) return {model_->faces()[at(faces_[0])].project(point), faces_[0]};
  // the face with the nearest triangle first: it leaves few others to look at
  int first = -1;
  double least = std::numeric_limits<double>::infinity();
  for (const int f : faces_) {
    const double bound = model_->faces()[at(f)].distance_at_least(point, least);
    if (first >= 0 && !(bound < least)) continue;
    first = f;
    least = bound;
  }
  Place best{model_->faces()[at(first)].project(point), first};
  for (const int f : faces_) {
    const auto& face = model_->faces()[at(f)];
    if (f == first || !(face.distance_at_least(point, best.foot.distance) <= best.foot.distance)) continue;
    const Place other{face.project(point), f};
    const double difference = other.foot.distance - best.foot.distance, rounding = equal_distance * model_->magnitude();
    if (difference < -rounding || (difference <= rounding && other.face < best.face)) best = other;
  }
  return best;
}

Vec3 CadSurface::normal(Vec3 point) const {
  const auto place = nearest(point);
  return model_->faces()[at(place.face)].normal(place.foot.uv);
}

std::optional<Vec3> CadSurface::nearest_of(const std::vector<int>& edges, Vec3 point, bool reachable_only) const {
  std::optional<Vec3> best;
  double least = std::numeric_limits<double>::infinity();
  for (const int e : edges) {
    const auto& edge = model_->edges()[at(e)];
    if (const double bound = edge.distance_at_least(point); bound * bound > least) continue;
    const auto foot = edge.nearest(point);
    const double reach = 0.5 * edge.length() + edge.tolerance() + near_edge * model_->size();
    if (foot.squared_distance >= least || (reachable_only && foot.squared_distance > reach * reach)) continue;
    least = foot.squared_distance;
    best = foot.point;
  }
  return best;
}

Vec3 CadSurface::project_to_seam(Vec3 point) const {
  if (const auto seam = nearest_of(inner_edges_, point, false)) return *seam;
  return project(point);
}

double CadSurface::off_face(int face, Vec3 a, Vec3 b, Vec3 c) const {
  return model_->faces()[at(face)].project((1.0 / 3) * (a + b + c)).distance;
}

/// The two triangles say which edge it is: one of them lies on each of its faces.
std::optional<Vec3> CadSurface::crease_between(Vec3 a, Vec3 b, Vec3 c, Vec3 d) const {
  const double slack = near_edge * model_->size();
  std::optional<Vec3> best;
  double least = std::numeric_limits<double>::infinity();
  const Vec3 middle = midpoint(a, b);
  for (const int e : inner_edges_) {
    const auto& edge = model_->edges()[at(e)];
    const double limit = slack + edge.tolerance();
    const auto is_on_it = [&](Vec3 p) {
      return edge.distance_at_least(p) <= limit && edge.nearest(p).squared_distance <= limit * limit;
    };
    if (!is_on_it(a) || !is_on_it(b)) continue;
    const auto nearest_face = [&](Vec3 third) {
      int nearest = -1;
      double off = std::numeric_limits<double>::infinity();
      for (const int f : model_->faces_of(e)) {
        if (!has(f) || model_->faces()[at(f)].project(third).distance > limit) continue;
        const double of_triangle = off_face(f, a, b, third);
        if (of_triangle < off) nearest = f;
        off = std::min(off, of_triangle);
      }
      return nearest;
    };
    const int of_c = nearest_face(c), of_d = nearest_face(d);
    if (of_c < 0 || of_d < 0 || of_c == of_d) continue;
    const auto foot = edge.nearest(middle);
    if (!(foot.squared_distance < least)) continue;
    least = foot.squared_distance;
    best = foot.point;
  }
  return best;
}

std::optional<Vec3> CadSurface::project_to_common(std::span<const Surface* const> surfaces, Vec3 point) const {
  std::vector<const CadSurface*> parts;
  for (const auto* surface : surfaces) {
    const auto* part = dynamic_cast<const CadSurface*>(surface);
    if (part == nullptr || part->model_ != model_) return std::nullopt;
    parts.push_back(part);
  }
  const auto is_common = [&](auto has_part) { return std::all_of(parts.begin(), parts.end(), has_part); };
  std::vector<int> common;
  for (const int e : edges_) {
    const auto& faces = model_->faces_of(e);
    if (is_common([&](const CadSurface* part) {
          return std::any_of(faces.begin(), faces.end(), [part](int f) { return part->has(f); });
        }))
      common.push_back(e);
  }
  auto best = nearest_of(common, point, true);
  const auto take_if_nearer = [&](Vec3 foot) {
    if (!best || norm(foot - point) < norm(*best - point)) best = foot;
  };
  for (const int f : faces_)  // patches on one face have all of it in common
    if (is_common([f](const CadSurface* part) { return part->has(f); }))
      take_if_nearer(model_->faces()[at(f)].project(point).point);
  if (parts.size() > 2)  // solids that touch have edges at which three surfaces meet
    if (const auto corner = nearest_corner(parts, point)) take_if_nearer(*corner);
  return best;
}

/// Corners: ends of edges at which faces of all the surfaces meet.
std::optional<Vec3> CadSurface::nearest_corner(std::span<const CadSurface* const> parts, Vec3 point) const {
  std::vector<std::uint64_t> parts_of_corner;
  std::vector<Vec3> corner;
  for (std::size_t e = 0; e < model_->edges().size(); ++e) {
    std::uint64_t here = 0;
    for (const int f : model_->faces_of(static_cast<int>(e)))
      for (std::size_t k = 0; k < parts.size(); ++k)
        if (parts[k]->has(f)) here |= std::uint64_t{1} << k;
    for (std::size_t k = 0; k < 2; ++k) {
      const auto vertex = model_->edges()[e].data().vertex[k];
      if (vertex < 0) continue;
      if (at(vertex) >= corner.size()) {
        corner.resize(at(vertex) + 1);
        parts_of_corner.resize(at(vertex) + 1, 0);
      }
      corner[at(vertex)] = k == 0 ? model_->edges()[e].points().front() : model_->edges()[e].points().back();
      parts_of_corner[at(vertex)] |= here;
    }
  }
  std::optional<Vec3> best;
  for (std::size_t v = 0; v < corner.size(); ++v)
    if (parts_of_corner[v] == (std::uint64_t{1} << parts.size()) - 1 &&
        (!best || norm(corner[v] - point) < norm(*best - point)))
      best = corner[v];
  return best;
}

bool CadSurface::is_flat() const { return faces_.size() == 1 && model_->faces()[at(faces_[0])].data().is_plane; }

}  // namespace pamr::geometry
