// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/triangulated_surface.hpp"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/parameters.hpp"

namespace pamr::geometry {

namespace {

constexpr double border = 1e-12;      // parameters this near to the border of a triangle lie on it
constexpr double gain = 1 - 1e-12;    // a squared distance must fall below this part to count as nearer
constexpr double rounding = 1e-14;    // of the largest coordinate
constexpr double side_border = 1e-9;  // the same where only the side counts
constexpr int walk_limit = 100;
/// Beside a crease the nearest flat triangle may be one beyond it. The nearest point is then on this side, and no farther.
constexpr double reach_over_crease = 4;

/// Parameters of the point s of the way from corner k to corner k + 1.
std::array<double, 2> on_edge(int k, double s) {
  if (k == 0) return {s, 0};
  return k == 1 ? std::array{1 - s, s} : std::array{0.0, 1 - s};
}

}  // namespace

std::shared_ptr<Triangulated::Shape> Triangulated::make_shape(const Triangulation& surface,
                                                              const CreaseOptions& options) {
  auto shape = std::make_shared<Shape>();
  for (const Vec3 p : surface.points) shape->magnitude = std::max(shape->magnitude, largest_coordinate(p));
  shape->features = find_features(surface, options);
  shape->corner = surface.triangles;
  curve_triangles(surface, *shape);
  find_pseudonormals(surface, *shape);
  return shape;
}

Triangulated::Triangulated(std::shared_ptr<const Triangulation> surface, const Options& options)
    : flat_(std::move(surface)), parts_(options.parts) {
  require_valid(*flat_, "triangulated surface", options.open_allowed);
  if (!(options.crease.angle > 0 && options.crease.angle <= 180))
    throw Error("feature_angle: expected degrees over 0 and up to 180, found " + decimal(options.crease.angle));
  if (!(options.crease.shortest >= 0))
    throw Error("shortest_crease: expected a length of 0 or more, found " + decimal(options.crease.shortest));
  auto creases = options.crease;
  if (parts_) {
    const auto borders = borders_of(*flat_, parts_->part);
    creases.borders.insert(creases.borders.end(), borders.begin(), borders.end());
  }
  shape_ = make_shape(*flat_, creases);
  take_piece(-1);
  if (options.near) take_piece(shape_->features.patch[at(nearest(checked_point(*options.near, "near")).triangle)]);
}

Triangulated::Triangulated(std::shared_ptr<const Shape> shape, std::shared_ptr<const Triangulation> flat,
                           int only_piece)
    : shape_(std::move(shape)), flat_(std::move(flat)) {
  take_piece(only_piece);
}

std::unique_ptr<const Triangulated> Triangulated::piece(int number) const {
  return std::unique_ptr<const Triangulated>(new Triangulated(shape_, flat_, number));
}

std::string Triangulated::part_of(int piece) const {
  if (!parts_) return {};
  const auto& patch = shape_->features.patch;
  const auto first = std::find(patch.begin(), patch.end(), piece) - patch.begin();
  return parts_->name[at(parts_->part[static_cast<std::size_t>(first)])];
}

std::vector<std::string> Triangulated::part_names() const {
  std::vector<std::string> names;
  if (parts_ && !stays_in_patch_)
    std::copy_if(parts_->name.begin(), parts_->name.end(), std::back_inserter(names),
                 [](const std::string& name) { return !name.empty(); });
  return names;
}

void Triangulated::take_piece(int only_piece) {
  triangle_of_tree_.clear();
  std::vector<std::array<Vec3, 3>> flat;
  for (std::size_t t = 0; t < flat_->triangles.size(); ++t) {
    if (only_piece >= 0 && shape_->features.patch[t] != only_piece) continue;
    const auto& corner = flat_->triangles[t];
    flat.push_back({flat_->points[at(corner[0])], flat_->points[at(corner[1])], flat_->points[at(corner[2])]});
    triangle_of_tree_.push_back(static_cast<int>(t));
  }
  tree_.emplace(flat);
  creases_.emplace(*flat_, shape_->features, only_piece);
  side_of_crease_.assign(shape_->features.creases.size(), {});
  for (const int t : triangle_of_tree_)
    for (std::size_t k = 0; k < 3; ++k) {
      const int crease = shape_->features.crease_at[at(t)][k];
      if (crease < 0 || side_of_crease_[at(crease)].triangle >= 0) continue;
      const bool runs_along = shape_->corner[at(t)][k] == shape_->features.creases[at(crease)].point[0];
      side_of_crease_[at(crease)] = {t, static_cast<int>(k), runs_along};
    }
  stays_in_patch_ = only_piece >= 0;
  is_flat_ = stays_in_patch_ && shape_->features.is_planar[at(only_piece)] != 0;
}

void Triangulated::curve_triangles(const Triangulation& surface, Shape& shape) {
  const auto& features = shape.features;
  const auto n = surface.triangles.size();
  std::vector<std::array<std::array<Vec3, 2>, 3>> inner(n);
  shape.curved.reserve(n);
  for (std::size_t t = 0; t < n; ++t) {
    const auto& corner = surface.triangles[t];
    std::array<Vec3, 3> p;
    for (std::size_t k = 0; k < 3; ++k) p[k] = surface.points[at(corner[k])];
    for (std::size_t k = 0; k < 3; ++k) {
      const auto next = (k + 1) % 3;
      const auto [other, edge] = features.neighbor[t][k];
      if (other >= 0 && at(other) < t) {  // the same bits from both sides
        inner[t][k] = {inner[at(other)][at(edge)][1], inner[at(other)][at(edge)][0]};
        continue;
      }
      const int number = features.crease_at[t][k];
      if (number >= 0) {
        const auto& crease = features.creases[at(number)];  // made from this triangle, so it runs the same way
        inner[t][k] = {inner_point(p[k], p[next], crease.tangent[0]), inner_point(p[next], p[k], -crease.tangent[1])};
      } else if (features.is_planar[at(features.patch[t])] != 0) {
        inner[t][k] = {p[k] + (1.0 / 3) * (p[next] - p[k]), p[next] + (1.0 / 3) * (p[k] - p[next])};
      } else {
        inner[t][k] = smooth_edge(p[k], p[next], features.normal[t][k], features.normal[t][next]);
      }
    }
    shape.curved.emplace_back(p, inner[t]);
  }
}

void Triangulated::find_pseudonormals(const Triangulation& surface, Shape& shape) {
  shape.pseudonormal.resize(surface.points.size());
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto& corner = surface.triangles[t];
      const Vec3 here = surface.points[at(corner[k])];
      const Vec3 a = surface.points[at(corner[(k + 1) % 3])] - here, b = surface.points[at(corner[(k + 2) % 3])] - here;
      const double angle = std::atan2(norm(cross(a, b)), dot(a, b));
      shape.pseudonormal[at(corner[k])] = shape.pseudonormal[at(corner[k])] + angle * shape.features.normal[t][k];
    }
}

bool Triangulated::try_triangle(Vec3 point, int triangle, double u, double v, Place& best) const {
  const Foot foot = shape_->curved[at(triangle)].nearest(point, u, v);
  if (!(foot.squared_distance < gain * best.foot.squared_distance)) return false;
  best = {foot, triangle};
  return true;
}

bool Triangulated::go_on(Vec3 point, Place& here) const {
  const auto [foot, triangle] = here;
  const std::array<double, 3> far{foot.v, 1 - foot.u - foot.v, foot.u};  // from edges 0, 1 and 2
  const auto may_cross = [&](int t, int k) {
    return shape_->features.neighbor[at(t)][at(k)].triangle >= 0 &&
           !(stays_in_patch_ && shape_->features.crease_at[at(t)][at(k)] >= 0);
  };
  for (int k = 0; k < 3; ++k) {
    if (!(far[at(k)] <= border)) continue;
    const int before = (k + 2) % 3;
    if (far[at(before)] <= border) {  // corner k: all the triangles around it, out and back
      Place best = here;
      int t = triangle, c = k;
      while (may_cross(t, c)) {
        const auto [next, edge] = shape_->features.neighbor[at(t)][at(c)];
        t = next;
        c = (edge + 1) % 3;
        if (t == triangle) break;
        const auto [u, v] = on_edge(c, 0);
        try_triangle(point, t, u, v, best);
      }
      if (t != triangle || !may_cross(t, k))
        for (t = triangle, c = k; may_cross(t, (c + 2) % 3);) {
          const auto [next, edge] = shape_->features.neighbor[at(t)][at((c + 2) % 3)];
          t = next;
          c = edge;
          if (t == triangle) break;
          const auto [u, v] = on_edge(c, 0);
          try_triangle(point, t, u, v, best);
        }
      if (best.triangle == triangle) return false;
      here = best;
      return true;
    }
    if (far[at((k + 1) % 3)] <= border || !may_cross(triangle, k)) continue;  // corner k + 1 has its own turn
    const auto [next, edge] = shape_->features.neighbor[at(triangle)][at(k)];
    const double s = k == 0 ? foot.u : (k == 1 ? foot.v : 1 - foot.v);
    const auto [u, v] = on_edge(edge, 1 - s);
    if (try_triangle(point, next, u, v, here)) return true;
  }
  return false;
}

Triangulated::Place Triangulated::nearest(Vec3 point) const {
  const auto hit = tree_->nearest(point);
  const int triangle = triangle_of_tree_[at(hit.triangle)];
  Place here{shape_->curved[at(triangle)].nearest(point, hit.u, hit.v), triangle};
  const auto walk = [&] {
    for (int i = 0; i < walk_limit && go_on(point, here); ++i) {
    }
  };
  walk();
  if (go_to_crease(point, here)) walk();
  return here;
}

bool Triangulated::go_to_crease(Vec3 point, Place& here) const {
  const double distance = std::sqrt(here.foot.squared_distance);
  if (!(distance > rounding * shape_->magnitude)) return false;
  const auto hit = creases_->nearest_within(point, reach_over_crease * distance);
  if (!hit) return false;
  const auto& side = side_of_crease_[at(hit->crease)];
  const double s = side.runs_along ? hit->u : 1 - hit->u;
  const auto try_from = [&](int triangle, int edge, double along) {
    const auto [u, v] = on_edge(edge, along);
    return try_triangle(point, triangle, u, v, here);
  };
  const bool is_nearer = try_from(side.triangle, side.edge, s);
  const auto [other, edge] = shape_->features.neighbor[at(side.triangle)][at(side.edge)];
  return (other >= 0 && !stays_in_patch_ && try_from(other, edge, 1 - s)) || is_nearer;
}

Vec3 Triangulated::onto_plane(int triangle, Vec3 point) const {
  const auto patch = at(shape_->features.patch[at(triangle)]);
  if (shape_->features.is_planar[patch] == 0) return point;
  const Vec3 normal = shape_->features.plane_normal[patch];
  return point - dot(point - shape_->features.plane_point[patch], normal) * normal;
}

Vec3 Triangulated::foot_of(const Place& here, Vec3 point) const {
  const Vec3 foot = onto_plane(here.triangle, here.foot.point);
  // Inside a planar piece only the distance from its plane changes; the way over parameters would round.
  const auto patch = at(shape_->features.patch[at(here.triangle)]);
  if (shape_->features.is_planar[patch] == 0) return foot;
  const Vec3 direct = onto_plane(here.triangle, point);
  return squared_norm(direct - foot) <= squared_norm(rounding * Vec3{shape_->magnitude, 0, 0}) ? direct : foot;
}

Vec3 Triangulated::project(Vec3 point) const { return foot_of(nearest(point), point); }

Vec3 Triangulated::unit_normal(int triangle, double u, double v) const {
  const auto patch = at(shape_->features.patch[at(triangle)]);
  if (shape_->features.is_planar[patch] != 0) return shape_->features.plane_normal[patch];
  const Vec3 normal = shape_->curved[at(triangle)].normal(u, v);
  const double length = norm(normal);
  return length > min_length ? (1 / length) * normal : shape_->features.normal[at(triangle)][0];
}

Vec3 Triangulated::normal(Vec3 point) const {
  const auto here = nearest(point);
  return unit_normal(here.triangle, here.foot.u, here.foot.v);
}

Vec3 Triangulated::outward(const Place& here) const {
  const auto [foot, triangle] = here;
  const std::array<double, 3> far{foot.v, 1 - foot.u - foot.v, foot.u};  // from edges 0, 1 and 2
  const Vec3 own = unit_normal(triangle, foot.u, foot.v);
  for (int k = 0; k < 3; ++k) {
    if (!(far[at(k)] <= side_border)) continue;
    if (far[at((k + 2) % 3)] <= side_border) return shape_->pseudonormal[at(shape_->corner[at(triangle)][at(k)])];
    if (far[at((k + 1) % 3)] <= side_border) continue;  // corner k + 1 has its own turn
    const auto [next, edge] = shape_->features.neighbor[at(triangle)][at(k)];
    if (next < 0) return own;
    const auto [u, v] = on_edge(edge, 1 - (k == 0 ? foot.u : (k == 1 ? foot.v : 1 - foot.v)));
    return own + unit_normal(next, u, v);
  }
  return own;
}

double Triangulated::signed_distance(Vec3 point) const {
  const auto here = nearest(point);
  const Vec3 from_foot = point - foot_of(here, point);
  const double distance = norm(from_foot);
  return dot(from_foot, outward(here)) < 0 ? -distance : distance;
}

Vec3 Triangulated::project_to_seam(Vec3 point) const {
  return creases_->is_empty() ? project(point) : creases_->nearest(point);
}

double Triangulated::facet_deviation(Vec3 point) const {
  const auto triangle = at(nearest(point).triangle);
  double largest = 0;
  for (const auto& [u, v] : {std::array{1.0 / 3, 1.0 / 3}, {0.5, 0.0}, {0.5, 0.5}, {0.0, 0.5}}) {
    const auto corner = [&](std::size_t k) { return flat_->points[at(shape_->corner[triangle][k])]; };
    const Vec3 on_facet = (1 - u - v) * corner(0) + u * corner(1) + v * corner(2);
    largest = std::max(largest, norm(shape_->curved[triangle].point(u, v) - on_facet));
  }
  return largest;
}

std::optional<Vec3> Triangulated::crease_between(Vec3 a, Vec3 b, Vec3 c, Vec3 d) const {
  if (!creases_->is_near(a, b)) return std::nullopt;
  const auto piece = [&](Vec3 third) { return piece_at((1.0 / 3) * (a + b + third)); };
  return creases_->between(a, b, {piece(c), piece(d)});
}

}  // namespace pamr::geometry
