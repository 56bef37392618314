// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/cad_edge.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "pamr/geometry/box.hpp"
#include "pamr/geometry/cad/newton_limits.hpp"

namespace pamr::geometry {

namespace {

constexpr int first_pieces = 8, deepest_piece = 10;
constexpr double box_margin = 2;           // times how far the curve may leave its chords
constexpr double vanishing_speed = 1e-12;  // of the size, per whole parameter: a derivative that gives no direction

}  // namespace

CadEdge::CadEdge(CadEdgeData data, double sagitta, double size) : data_(std::move(data)), size_(size) {
  const double width = data_.end - data_.begin;
  auto from = sample(data_.begin);
  samples_.push_back(from.t);
  points_.push_back(from.point);
  for (int i = 1; i <= first_pieces; ++i) {
    const auto to = sample(i == first_pieces ? data_.end : data_.begin + width * i / first_pieces);
    add_samples(from, to, sagitta, 0);
    from = to;
  }
  for (std::size_t i = 1; i < points_.size(); ++i) length_ += norm(points_[i] - points_[i - 1]);
  box_ = box_of(points_);
  const Vec3 margin = box_margin * sagitta * Vec3{1, 1, 1};
  box_.low -= margin;
  box_.high += margin;
}

void CadEdge::join(std::size_t end, Vec3 corner) {
  (end == 0 ? points_.front() : points_.back()) = corner;
  box_.extend(corner);
}

Vec3 CadEdge::point(double t) const {
  if (t == data_.begin) return points_.front();
  return t == data_.end ? points_.back() : data_.curve->at(t).point;
}

double CadEdge::distance_at_least(Vec3 point) const { return std::sqrt(box_.squared_distance(point)); }

void CadEdge::add_samples(const Sample& from, const Sample& to, double sagitta, int depth) {
  const auto middle = sample(0.5 * (from.t + to.t));
  if (depth < deepest_piece && norm(middle.point - midpoint(from.point, to.point)) > sagitta) {
    add_samples(from, middle, sagitta, depth + 1);
    add_samples(middle, to, sagitta, depth + 1);
    return;
  }
  samples_.push_back(to.t);
  points_.push_back(to.point);
}

Vec3 CadEdge::tangent(double t) const {
  const double width = data_.end - data_.begin;
  const Vec3 first = data_.curve->at(t).first;
  if (norm(first) * width > vanishing_speed * size_) return (1.0 / norm(first)) * first;
  const double small = 1e-4 * width;
  const Vec3 chord = t + small <= data_.end ? point(t + small) - point(t) : point(t) - point(t - small);
  return norm(chord) > 0 ? (1.0 / norm(chord)) * chord : Vec3{1, 0, 0};
}

CadEdgeFoot CadEdge::nearest(Vec3 to, double t) const {
  t = std::clamp(t, data_.begin, data_.end);
  auto jet = data_.curve->at(t);
  CadEdgeFoot best{jet.point, t, dot(jet.point - to, jet.point - to)};
  double last = std::numeric_limits<double>::infinity();
  for (int i = 0; i < newton::max_steps; ++i) {
    const Vec3 r = jet.point - to;
    const double slope = dot(r, jet.first), speed = dot(jet.first, jet.first);
    double bend = speed + dot(r, jet.second);
    if (!(bend > 0.05 * speed)) bend = speed;
    if (!(bend > 0)) break;
    double next = std::clamp(best.t - slope / bend, data_.begin, data_.end);
    auto there = data_.curve->at(next);
    double squared = dot(there.point - to, there.point - to);
    double step = norm(there.point - best.point);
    for (int k = 0; k < newton::max_steps && squared > best.squared_distance && step > newton::sure_to_fall * size_;
         ++k) {
      next = 0.5 * (next + best.t);
      there = data_.curve->at(next);
      squared = dot(there.point - to, there.point - to);
      step = norm(there.point - best.point);
    }
    if (next == best.t) break;
    best = {there.point, next, squared};
    jet = there;
    if (step <= newton::at_rest * size_ || (step <= newton::rounding * size_ && !(step < 0.5 * last))) break;
    last = step;
  }
  for (const double end : {data_.begin, data_.end}) {
    const Vec3 corner = point(end);
    const double squared = dot(corner - to, corner - to);
    if (squared < best.squared_distance || best.t == end) best = {corner, end, squared};
  }
  return best;
}

CadEdgeFoot CadEdge::nearest(Vec3 to) const {
  CadEdgeFoot best;
  double least = -1;
  for (std::size_t i = 0; i + 1 < points_.size(); ++i) {
    const Vec3 chord = points_[i + 1] - points_[i];
    const double squared_length = dot(chord, chord);
    const double s = squared_length > 0 ? std::clamp(dot(to - points_[i], chord) / squared_length, 0.0, 1.0) : 0.0;
    const Vec3 off = to - (points_[i] + s * chord);
    if (least >= 0 && !(dot(off, off) < least)) continue;
    least = dot(off, off);
    best.t = samples_[i] + s * (samples_[i + 1] - samples_[i]);
  }
  return nearest(to, best.t);
}

}  // namespace pamr::geometry
