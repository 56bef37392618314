// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/cad/cad_face.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/cad/newton_limits.hpp"

namespace pamr::geometry {

namespace {

constexpr double beyond_box = 0.05;   // of the parameters' range: how far a search may leave the face
constexpr double at_pole = 1e-9;      // of the size
constexpr double one_point = 1e-7;    // of the size: within it a side of the parameters is a pole
constexpr double beside_pole = 1e-3;  // of the parameters' range: where directions from a pole are looked at
constexpr int pole_directions = 16;
constexpr double box_slack = 1e-6;     // of the parameters' range
constexpr double safely_inside = 0.8;  // of the clearance
constexpr double near_border = 3;      // times how far the triangles may lie off the face
constexpr double near_triangle = 2;    // the same; between this and the one above there is a whole such distance
constexpr double flat_slack = 1e-7;    // of the size: what a face that is its triangles gets for rounding
constexpr double degenerate = 1e-9;    // sine and relative length below which u x v has no direction
constexpr double deflection_factor = 1.5;
constexpr int gap_points = 9;

double shifted(double value, double low, double high, double period) {
  if (period <= 0) return value;
  const double middle = 0.5 * (low + high);
  return value - period * std::round((value - middle) / period);
}

/// A step downhill to the nearest point: Newton's where the distance is convex, else Gauss-Newton's.
Uv newton_step(const SurfaceJet& jet, Vec3 to) {
  const Vec3 r = jet.point - to;
  const double gu = dot(r, jet.u), gv = dot(r, jet.v);
  const double uu = dot(jet.u, jet.u), uv = dot(jet.u, jet.v), vv = dot(jet.v, jet.v);
  double a = uu + dot(r, jet.uu), b = uv + dot(r, jet.uv), c = vv + dot(r, jet.vv);
  double det = a * c - b * b;
  if (!(a > 0.02 * uu && c > 0.02 * vv && det > 1e-3 * uu * vv)) {
    a = uu;
    b = uv;
    c = vv;
    det = a * c - b * b;
  }
  if (det > 1e-14 * a * c) return {(b * gv - c * gu) / det, (b * gu - a * gv) / det};
  return {a > 0 ? -gu / a : 0, c > 0 ? -gv / c : 0};  // at a pole one of the derivatives vanishes
}

}  // namespace

CadFace::CadFace(CadFaceData data, std::span<const CadEdge> edges, double size)
    : data_(std::move(data)), edges_(edges), size_(size) {
  if (data_.triangle.empty()) throw Error("expected a face that can be sampled, found one without area");
  for (const auto uv : data_.sample) points_.push_back(data_.surface->point(uv));
  find_poles();
  std::vector<std::array<Vec3, 3>> corners;
  for (const auto& t : data_.triangle) {
    corners.push_back({points_[at(t[0])], points_[at(t[1])], points_[at(t[2])]});
    const auto off = [&](std::array<double, 3> w) {
      const auto flat = w[0] * corners.back()[0] + w[1] * corners.back()[1] + w[2] * corners.back()[2];
      return norm(flat - data_.surface->point(at_weights(t, w)));
    };
    deflection_ = std::max(
        {deflection_, off({1 / 3.0, 1 / 3.0, 1 / 3.0}), off({0.5, 0.5, 0}), off({0, 0.5, 0.5}), off({0.5, 0, 0.5})});
  }
  triangles_.emplace(corners);
  std::vector<std::array<Vec3, 3>> segments;
  for (std::size_t b = 0; b < data_.border.size(); ++b) {
    const auto& edge = edges_[at(data_.border[b].edge)];
    for (std::size_t i = 0; i + 1 < edge.points().size(); ++i) {
      segments.push_back({edge.points()[i], edge.points()[i + 1], edge.points()[i + 1]});
      chords_.push_back({static_cast<int>(b), edge.samples()[i], edge.samples()[i + 1]});
    }
  }
  for (const auto& chord : chords_) {  // between the triangles and a curved border there is more of the face
    const Vec3 p = edges_[at(data_.border[at(chord.border)].edge)].point(0.5 * (chord.begin + chord.end));
    deflection_ = std::max(deflection_, norm(p - flat_point(triangles_->nearest(p))));
  }
  deflection_ *= deflection_factor;
  if (segments.empty()) return;
  borders_.emplace(segments);
  for (const auto& [p, q, r] : corners)
    clearance_.push_back(std::sqrt(nearest_border((1.0 / 3) * (p + q + r)).foot.squared_distance));
}

void CadFace::find_poles() {
  if (data_.pole.empty() || data_.surface->foot(data_.pole[0])) return;
  for (const bool fixes_u : {false, true})
    for (const bool is_low : {true, false}) {
      const auto& ends = fixes_u ? std::array{data_.low.u, data_.high.u} : std::array{data_.low.v, data_.high.v};
      Pole pole{{}, fixes_u, ends[is_low ? 0 : 1], ends[is_low ? 1 : 0], 0, false};
      pole.point = data_.surface->point(beside(pole, 0, 0));
      bool is_one_point = true;
      for (int i = 1; i <= pole_directions; ++i)
        is_one_point = is_one_point && norm(data_.surface->point(beside(pole, 1.0 * i / pole_directions, 0)) -
                                            pole.point) <= one_point * size_;
      if (!is_one_point) continue;
      pole.is_closed = norm(data_.surface->point(beside(pole, 0, beside_pole)) -
                            data_.surface->point(beside(pole, 1, beside_pole))) <= one_point * size_;
      for (const auto& t : data_.triangle)
        if (std::any_of(t.begin(), t.end(), [&](int i) { return is_at(pole, data_.sample[at(i)]); }))
          for (const int i : t) pole.reach = std::max(pole.reach, norm(points_[at(i)] - pole.point));
      poles_.push_back(pole);
    }
}

bool CadFace::is_at(const Pole& pole, Uv uv) const {
  return std::abs((pole.fixes_u ? uv.u : uv.v) - pole.side) <= box_slack * std::abs(pole.inside - pole.side);
}

/// The parameters at a part of the side, and at a part of the way to the opposite one.
Uv CadFace::beside(const Pole& pole, double along, double inwards) const {
  const double across = pole.side + inwards * (pole.inside - pole.side);
  if (pole.fixes_u) return {across, data_.low.v + along * (data_.high.v - data_.low.v)};
  return {data_.low.u + along * (data_.high.u - data_.low.u), across};
}

/// Where to begin the search for a point near a pole: derivatives there say nothing of directions, and the samples have
/// one of all the parameters that belong to it. Of some directions into the face that which comes nearest to the
/// point's, seen along the normal.
Uv CadFace::start_at(const Pole& pole, Vec3 point) const {
  std::array<Vec3, pole_directions> ray;
  const auto part = [](std::size_t i) { return (static_cast<double>(i) + 0.5) / pole_directions; };
  for (std::size_t i = 0; i < ray.size(); ++i)
    ray[i] = data_.surface->point(beside(pole, part(i), beside_pole)) - pole.point;
  Vec3 normal;
  for (std::size_t i = 0; i + 1 < ray.size(); ++i) normal = normal + cross(ray[i], ray[i + 1]);
  if (pole.is_closed) normal = normal + cross(ray.back(), ray.front());
  if (const double length = norm(normal); length > 0) normal = (1 / length) * normal;
  const auto flat = [&](Vec3 v) { return v - dot(v, normal) * normal; };
  const Vec3 to = point - pole.point;
  Uv start = beside(pole, 0.5, 0);
  double farthest = 0;
  for (std::size_t i = 0; i < ray.size(); ++i) {
    const Vec3 along = flat(ray[i]);
    const double length = norm(along), ahead = length > 0 ? dot(to, along) / length : 0;
    if (ahead <= farthest) continue;
    farthest = ahead;
    const double on_ray = dot(to, ray[i]) / dot(ray[i], ray[i]);  // of a point high above a cone far less than `ahead`
    start = beside(pole, part(i), std::min(1.0, beside_pole * (on_ray > 0 ? on_ray : ahead / length)));
  }
  return start;
}

/// Parameters of a point of a flat triangle. A corner at a pole has all the parameters along that side: it takes those
/// of the other corners.
Uv CadFace::at_weights(const std::array<int, 3>& triangle, const std::array<double, 3>& weight) const {
  const auto mean = [&](double Uv::*parameter, bool of_u) {
    double sum = 0, whole = 0, equal = 0;
    int n = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      const Uv uv = data_.sample[at(triangle[k])];
      if (std::any_of(poles_.begin(), poles_.end(), [&](const Pole& p) { return p.fixes_u != of_u && is_at(p, uv); }))
        continue;
      sum += weight[k] * uv.*parameter;
      whole += weight[k];
      equal += uv.*parameter;
      ++n;
    }
    const auto of = [&](std::size_t k) { return data_.sample[at(triangle[k])].*parameter; };
    if (n == 3) return of(0) + weight[1] * (of(1) - of(0)) + weight[2] * (of(2) - of(0));
    if (n == 0) return of(0);
    return whole > box_slack ? sum / whole : equal / n;
  };
  return {mean(&Uv::u, true), mean(&Uv::v, false)};
}

Uv CadFace::in_period(Uv uv) const {
  return {shifted(uv.u, data_.low.u, data_.high.u, data_.period.u),
          shifted(uv.v, data_.low.v, data_.high.v, data_.period.v)};
}

Uv CadFace::foot(Vec3 point, Uv start) const {
  if (const auto closed = data_.surface->foot(point)) return in_period(*closed);
  const double width_u = data_.high.u - data_.low.u, width_v = data_.high.v - data_.low.v;
  const auto limited = [&](Uv uv) {
    return Uv{std::clamp(uv.u, data_.low.u - beyond_box * width_u, data_.high.u + beyond_box * width_u),
              std::clamp(uv.v, data_.low.v - beyond_box * width_v, data_.high.v + beyond_box * width_v)};
  };
  Uv here = start;
  auto jet = data_.surface->at(here);
  double least = dot(jet.point - point, jet.point - point), last = std::numeric_limits<double>::infinity();
  for (int i = 0; i < newton::max_steps; ++i) {
    const Uv step = newton_step(jet, point);
    Uv next = limited({here.u + step.u, here.v + step.v});
    auto there = data_.surface->at(next);
    double squared = dot(there.point - point, there.point - point), length = norm(there.point - jet.point);
    for (int k = 0; k < newton::max_steps && squared > least && length > newton::sure_to_fall * size_; ++k) {
      next = {0.5 * (next.u + here.u), 0.5 * (next.v + here.v)};
      there = data_.surface->at(next);
      squared = dot(there.point - point, there.point - point);
      length = norm(there.point - jet.point);
    }
    if (next.u == here.u && next.v == here.v) break;
    here = next;
    jet = there;
    least = squared;
    if (length <= newton::at_rest * size_ || (length <= newton::rounding * size_ && !(length < 0.5 * last))) break;
    last = length;
  }
  return here;
}

CadFace::BorderFoot CadFace::nearest_border(Vec3 point) const {
  BorderFoot best;
  if (borders_) {
    const auto hit = borders_->nearest(point);
    const auto& chord = chords_[at(hit.triangle)];
    const auto edge_of = [&](int border) -> const CadEdge& { return edges_[at(data_.border[at(border)].edge)]; };
    const double along = hit.u + hit.v;  // both far corners are the far end of the chord
    best = {chord.border, edge_of(chord.border).nearest(point, chord.begin + along * (chord.end - chord.begin))};
    const auto& nearest = edge_of(best.border).data();
    int vertex = -1;
    if (best.foot.t == nearest.begin) vertex = nearest.vertex[0];
    if (best.foot.t == nearest.end) vertex = nearest.vertex[1];
    for (std::size_t b = 0; vertex >= 0 && b < data_.border.size(); ++b) {  // another edge may lead on from here
      const auto& edge = edge_of(static_cast<int>(b));
      for (std::size_t k = 0; k < 2; ++k) {
        if (edge.data().vertex[k] != vertex) continue;
        const auto foot = edge.nearest(point, k == 0 ? edge.data().begin : edge.data().end);
        if (foot.squared_distance < best.foot.squared_distance) best = {static_cast<int>(b), foot};
      }
    }
  }
  for (const auto pole : data_.pole) {
    const double squared = dot(point - pole, point - pole);
    if (squared < best.foot.squared_distance) best = {-1, {pole, 0, squared}};
  }
  return best;
}

Vec3 CadFace::inward(const CadBorder& border, double t, Vec3 surface_normal) const {
  const Vec3 left = cross(surface_normal, edges_[at(border.edge)].tangent(t));
  return border.material_left ? left : -1.0 * left;
}

bool CadFace::is_inside(Uv uv, Vec3 on_surface, const BorderFoot& nearest) const {
  const double slack_u = box_slack * (data_.high.u - data_.low.u), slack_v = box_slack * (data_.high.v - data_.low.v);
  if (uv.u < data_.low.u - slack_u || uv.u > data_.high.u + slack_u || uv.v < data_.low.v - slack_v ||
      uv.v > data_.high.v + slack_v)
    return false;
  if (nearest.border < 0) return true;  // there is no border, or a pole is nearer
  // the direction into the face at the nearest border says nothing about what is far from there: the other side of a
  // pipe with an opening. There the triangles decide.
  const double reach = deflection_ + flat_slack * size_;
  if (nearest.foot.squared_distance > near_border * near_border * reach * reach)
    return norm(on_surface - flat_point(triangles_->nearest(on_surface))) <= near_triangle * reach;
  const auto& border = data_.border[at(nearest.border)];
  const auto& edge = edges_[at(border.edge)].data();
  const Vec3 normal = cross_normal(uv);
  int vertex = -1;
  if (nearest.foot.t == edge.begin) vertex = edge.vertex[0];
  if (nearest.foot.t == edge.end) vertex = edge.vertex[1];
  if (vertex < 0) return dot(on_surface - nearest.foot.point, inward(border, nearest.foot.t, normal)) >= 0;
  Vec3 sum;  // at a corner the mean direction decides, as it does for polygons
  for (const auto& other : data_.border)
    for (std::size_t k = 0; k < 2; ++k)
      if (const auto& of_other = edges_[at(other.edge)].data(); of_other.vertex[k] == vertex)
        sum = sum + inward(other, k == 0 ? of_other.begin : of_other.end, normal);
  return dot(on_surface - nearest.foot.point, sum) >= 0;
}

CadFoot CadFace::project(Vec3 point) const {
  const auto hit = triangles_->nearest(point);
  const Vec3 flat = flat_point(hit);
  auto result = project_from(point, seed(hit), hit.triangle);
  for (const auto& pole : poles_) {
    if (norm(flat - pole.point) > pole.reach) continue;
    if (const auto other = project_from(point, start_at(pole, point), -1); other.distance < result.distance)
      result = other;
  }
  if (result.distance <= norm(point - flat) + deflection_) return result;
  return project_from_samples(point, result);
}

/// `triangle`: the one that holds the start, -1 for none.
CadFoot CadFace::project_from(Vec3 point, Uv start, int triangle) const {
  const Uv uv = foot(point, start);
  const Vec3 q = data_.surface->point(uv);
  const CadFoot result{q, uv, norm(point - q)};
  if (!borders_) return result;
  if (triangle >= 0) {
    const auto& t = data_.triangle[at(triangle)];
    const Vec3 middle = (1.0 / 3) * (points_[at(t[0])] + points_[at(t[1])] + points_[at(t[2])]);
    if (norm(q - middle) < safely_inside * clearance_[at(triangle)] - deflection_) return result;
  }
  const auto at_border = nearest_border(point);
  const double off = std::sqrt(at_border.foot.squared_distance);
  if (is_inside(uv, q, nearest_border(q))) {
    // a node of the border lies on its curve, which may be off the surface; so may a pole by rounding
    const double reach =
        at_border.border < 0 ? at_pole * size_ : edges_[at(data_.border[at(at_border.border)].edge)].tolerance();
    const bool is_of_border = off < result.distance && off <= reach;
    return is_of_border ? CadFoot{at_border.foot.point, uv, off} : result;
  }
  return {at_border.foot.point, foot(at_border.foot.point, uv), off};
}

/// For a face that folds back on itself: the search from the nearest triangle came to a point that is farther than the
/// triangle. The nearest samples are starts, and feet themselves.
CadFoot CadFace::project_from_samples(Vec3 point, CadFoot best) const {
  constexpr std::size_t most = 16;
  std::vector<std::pair<double, std::size_t>> nearest;
  for (std::size_t i = 0; i < points_.size(); ++i) nearest.emplace_back(norm(point - points_[i]), i);
  const auto end = nearest.begin() + static_cast<std::ptrdiff_t>(std::min(most, nearest.size()));
  std::partial_sort(nearest.begin(), end, nearest.end());
  for (auto n = nearest.begin(); n != end; ++n) {
    const auto& [distance, i] = *n;
    if (distance < best.distance) best = {points_[i], data_.sample[i], distance};
    if (const auto other = project_from(point, data_.sample[i], -1); other.distance < best.distance) best = other;
  }
  return best;
}

Vec3 CadFace::cross_normal(Uv uv) const {
  const Uv middle{0.5 * (data_.low.u + data_.high.u), 0.5 * (data_.low.v + data_.high.v)};
  for (double towards = 0; towards<0.5; towards = towards> 0 ? 10 * towards : 1e-6) {
    const auto jet = data_.surface->at({uv.u + towards * (middle.u - uv.u), uv.v + towards * (middle.v - uv.v)});
    const Vec3 n = cross(jet.u, jet.v);
    const double u = norm(jet.u) * (data_.high.u - data_.low.u), v = norm(jet.v) * (data_.high.v - data_.low.v);
    if (norm(n) > degenerate * norm(jet.u) * norm(jet.v) && std::min(u, v) > degenerate * size_)
      return (1.0 / norm(n)) * n;
  }
  return {0, 0, 1};
}

Vec3 CadFace::normal(Uv uv) const { return data_.is_reversed ? -1.0 * cross_normal(uv) : cross_normal(uv); }

double CadFace::distance_at_least(Vec3 point, double limit) const {
  const auto hit = triangles_->nearest(point, limit + deflection_);
  if (hit.triangle < 0) return std::numeric_limits<double>::infinity();
  return std::max(0.0, norm(point - flat_point(hit)) - deflection_);
}

Vec3 CadFace::flat_point(const TriangleTree::Hit& hit) const {
  const auto& t = data_.triangle[at(hit.triangle)];
  const Vec3 a = points_[at(t[0])], b = points_[at(t[1])], c = points_[at(t[2])];
  return a + hit.u * (b - a) + hit.v * (c - a);
}

Uv CadFace::seed(const TriangleTree::Hit& hit) const {
  return at_weights(data_.triangle[at(hit.triangle)], {1 - hit.u - hit.v, hit.u, hit.v});
}

double CadFace::gap(int border) const {
  const auto& edge = edges_[at(data_.border[at(border)].edge)];
  double worst = 0;
  for (int i = 0; i < gap_points; ++i) {
    const double t = edge.data().begin + (edge.data().end - edge.data().begin) * i / (gap_points - 1);
    const Vec3 p = edge.point(t);
    const Uv uv = foot(p, seed(triangles_->nearest(p)));
    worst = std::max(worst, norm(p - data_.surface->point(uv)));
  }
  return worst;
}

}  // namespace pamr::geometry
