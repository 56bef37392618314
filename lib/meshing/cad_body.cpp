// SPDX-License-Identifier: GPL-3.0-or-later
#include "meshing/cad_body.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>
#include <utility>

#include "pamr/base/error.hpp"
#include "pamr/base/index.hpp"
#include "pamr/geometry/cad/read_cad.hpp"
#include "pamr/geometry/parameters.hpp"

namespace pamr::meshing {
namespace {

using geometry::Vec3;
using Polyline = std::vector<Vec3>;

constexpr double tip_cosine = 0.9;  // of two normals at a pole: less is a tip
constexpr int deepest = 12;         // of halving a chord of an edge

std::vector<int> all_faces(const geometry::CadModel& model) {
  std::vector<int> all(model.faces().size());
  std::iota(all.begin(), all.end(), 0);
  return all;
}

geometry::CadTriangles triangles_of(const geometry::CadModel& model, double longest_error) {
  constexpr double finest = 1e-5, coarsest = 1e-3;
  const auto& origin = model.origin();
  return geometry::triangulate_cad(*origin.text, origin.scale,
                                   std::clamp(longest_error / model.size(), finest, coarsest), origin.is_assembly);
}

/// Points of an edge between two parameters, without the first.
void add_points(const geometry::CadEdge& edge, double from, Vec3 a, double to, Vec3 b, double sagitta, int depth,
                Polyline& points) {
  const double middle = 0.5 * (from + to);
  const Vec3 m = edge.point(middle);
  if (depth > 0 && norm(m - midpoint(a, b)) > sagitta) {
    add_points(edge, from, a, middle, m, sagitta, depth - 1, points);
    add_points(edge, middle, m, to, b, sagitta, depth - 1, points);
  } else {
    points.push_back(m);
    points.push_back(b);
  }
}

Polyline polyline_of(const geometry::CadEdge& edge, double sagitta) {
  Polyline points{edge.points().front()};
  for (std::size_t i = 1; i < edge.samples().size(); ++i)
    add_points(edge, edge.samples()[i - 1], edge.points()[i - 1], edge.samples()[i], edge.points()[i], sagitta, deepest,
               points);
  return points;
}

[[noreturn]] void refuse_open(const geometry::CadModel& model, const ClosedTriangles& triangles, int face) {
  const auto& name = model.faces()[at(face)].data().name;
  throw Error(fmt::format(
      "expected a closed shape, found one that is open at {} places{}, the first near {} at face {}{}: sew it with "
      "gmsh "
      "part.step -setnumber Geometry.OCCSewFaces 1 -setnumber Geometry.OCCMakeSolids 1 -0 -o sewn.brep, and mesh "
      "sewn.brep; or export a solid",
      triangles.n_open(), model.n_solids() > 0 ? "" : " (shells without a solid)",
      geometry::decimal(triangles.open_point()), face + 1, name.empty() ? "" : " \"" + name + "\""));
}

std::string label_of(const geometry::CadSolids& solids, int number) {
  const auto& solid = solids.solid[at(number - 1)];
  return fmt::format("{}{} (its middle at {})", number, solid.name.empty() ? "" : " \"" + solid.name + "\"",
                     geometry::decimal(solid.middle));
}

/// Refuses solids that are not clear of one another, and faces beside solids.
void require_solids(const geometry::CadSolids& solids) {
  const auto n = solids.solid.size();
  if (!solids.contact.empty()) {
    std::string pairs;
    for (const auto& c : solids.contact)
      pairs += fmt::format("{}{} {} {}, at {}", pairs.empty() ? "" : "; ", label_of(solids, c.first),
                           c.is_nested ? "lies inside of" : "touches or overlaps", label_of(solids, c.second),
                           geometry::decimal(c.where));
    throw Error(fmt::format(
        "expected one solid, or solids clear of one another, found {} of which {}: `pamr-mesh` given the file itself, "
        "without a case, makes a region of each; or unite the solids, cut the inner one out of the outer one, or "
        "export "
        "one of them",
        n, pairs));
  }
  if (n > 0) require_no_loose_faces(n, solids.loose_face);
}

}  // namespace

void require_no_loose_faces(std::size_t n_solids, const std::vector<geometry::CadLooseFace>& loose) {
  if (loose.empty()) return;
  const auto& face = loose.front();
  const bool is_one = loose.size() == 1;
  throw Error(
      fmt::format("expected solids alone, found {} solid{}, and {} face{} that belong{} to none, {}at {} (face {}): a "
                  "shell without "
                  "a solid bounds no region; take {} out of the file",
                  n_solids, n_solids == 1 ? "" : "s", loose.size(), is_one ? "" : "s", is_one ? "s" : "",
                  is_one ? "" : "the first ", geometry::decimal(face.where), face.face + 1, is_one ? "it" : "them"));
}

CadBody::CadBody(std::shared_ptr<const geometry::CadModel> model, double longest_error)
    : model_(std::move(model)), faces_(model_, all_faces(*model_)) {
  const auto triangles = triangles_of(*model_, longest_error);
  require_solids(triangles.solids);
  point_ = triangles.point;
  corner_ = triangles.corner;
  face_ = triangles.face;
  for (const auto& solid : triangles.solids.solid) volume_.push_back(solid.volume);
  second_solid_.assign(model_->faces().size(), -1);
  if (model_->origin().is_assembly)
    add_solids(triangles.solids);
  else
    add_inside(corner_, face_);
  find_tips();
  add_lines(longest_error);
}

void CadBody::add_inside(std::span<const std::array<int, 3>> corner, std::span<const int> face) {
  const auto& added = inside_.emplace_back(point_, corner);
  if (added.n_open() > 0) refuse_open(*model_, added, face[at(added.open_triangle())]);
}

void CadBody::add_solids(const geometry::CadSolids& solids) {
  std::vector<std::vector<std::size_t>> triangles_of_face(model_->faces().size());
  for (std::size_t t = 0; t < face_.size(); ++t) triangles_of_face[at(face_[t])].push_back(t);
  std::vector<bool> has_solid(model_->faces().size(), false);
  for (std::size_t s = 0; s < solids.solid.size(); ++s) {
    std::vector<std::array<int, 3>> corner;
    std::vector<int> face;
    for (const auto& side : solids.solid[s].sides) {
      for (const auto t : triangles_of_face[at(side.face)]) {
        const auto& [a, b, c] = corner_[t];
        corner.push_back(side.is_flipped ? std::array{a, c, b} : corner_[t]);
        face.push_back(side.face);
      }
      if (has_solid[at(side.face)]) second_solid_[at(side.face)] = static_cast<int>(s);
      has_solid[at(side.face)] = true;
    }
    add_inside(corner, face);
  }
  std::vector<std::array<Vec3, 3>> all, outer;
  for (std::size_t t = 0; t < corner_.size(); ++t) {
    const auto& [a, b, c] = corner_[t];
    all.push_back({point_[at(a)], point_[at(b)], point_[at(c)]});
    if (is_between_solids(face_[t])) continue;
    outer.push_back(all.back());
    outer_face_.push_back(face_[t]);
  }
  all_ = std::make_unique<const geometry::TriangleTree>(all);
  outer_ = std::make_unique<const geometry::TriangleTree>(outer);
}

int CadBody::solid_at(Vec3 point) const {
  int deepest = -1, touched = -1, n_touched = 0;
  double least = 0;
  for (std::size_t s = 0; s < inside_.size(); ++s) {
    if (!inside_[s].box().contains(point)) continue;
    const double distance = inside_[s].signed_distance(point);
    if (distance < least) {
      least = distance;
      deepest = static_cast<int>(s);
    } else if (distance == 0 && n_touched++ == 0) {
      touched = static_cast<int>(s);
    }
  }
  return deepest < 0 && n_touched > 1 ? touched : deepest;
}

double CadBody::signed_distance(Vec3 point) const {
  if (!all_) return inside_.front().signed_distance(point);
  const auto [triangle, u, v] = all_->nearest(point);
  const auto& [a, b, c] = corner_[at(triangle)];
  const double distance = norm(point - ((1 - u - v) * point_[at(a)] + u * point_[at(b)] + v * point_[at(c)]));
  return solid_at(point) >= 0 ? -distance : distance;
}

Vec3 CadBody::normal(Vec3 point) const {
  if (!all_) return faces_.normal(point);
  // Beyond a sharp edge the face between two solids may be nearer than those at which the point left them.
  const int solid = solid_at(point), piece = solid < 0 ? outer_piece_at(point) : piece_at(point);
  const auto& face = model_->faces()[at(piece)];
  const Vec3 outward = face.normal(face.project(point).uv);
  return solid >= 0 && second_solid_[at(piece)] == solid ? -1.0 * outward : outward;
}

std::vector<std::array<Vec3, 3>> CadBody::triangles() const {
  std::vector<std::array<Vec3, 3>> result;
  for (std::size_t t = 0; t < corner_.size(); ++t) {
    const auto& [a, b, c] = corner_[t];
    result.push_back({point_[at(a)], point_[at(b)], point_[at(c)]});
    if (is_between_solids(face_[t])) result.push_back({point_[at(a)], point_[at(c)], point_[at(b)]});
  }
  return result;
}

int CadBody::piece_at(Vec3 point) const {
  return face_[at(all_ ? all_->nearest(point).triangle : inside_.front().nearest(point))];
}

int CadBody::outer_piece_at(Vec3 point) const {
  return outer_ ? outer_face_[at(outer_->nearest(point).triangle)] : piece_at(point);
}

std::shared_ptr<const geometry::Surface> CadBody::piece(int number) const {
  return std::make_shared<geometry::CadSurface>(model_, std::vector<int>{number});
}

void CadBody::for_each_sample(const std::function<void(int, Vec3)>& use) const {
  for (std::size_t f = 0; f < model_->faces().size(); ++f)
    for (const Vec3 p : model_->faces()[f].points()) use(static_cast<int>(f), p);
}

Vec3 CadBody::nearest_on_line(std::size_t number, Vec3 point) const {
  return model_->edges()[at(line_[number].edge)].nearest(point).point;
}

Vec3 CadBody::around(const Tip& tip, double part, double distance) const {
  const auto& data = model_->faces()[at(tip.face)].data();
  const auto point = [&](double along) {
    const double up = tip.at_low ? along : 1 - along, u = tip.along_u ? part : up, v = tip.along_u ? up : part;
    return data.surface->point(
        {data.low.u + u * (data.high.u - data.low.u), data.low.v + v * (data.high.v - data.low.v)});
  };
  double near = 0, far = 1;
  for (int i = 0; i < 50; ++i) {
    const double middle = 0.5 * (near + far);
    (norm(point(middle) - tip.point) < distance ? near : far) = middle;
  }
  return point(far);
}

void CadBody::find_tips() {
  constexpr double at_tip = 1e-6, beside = 1e-3;  // of the size
  for (std::size_t f = 0; f < model_->faces().size(); ++f)
    for (const Vec3 pole : model_->faces()[f].data().pole)
      for (const bool along_u : {true, false})
        for (const bool at_low : {true, false}) {
          const Tip tip{static_cast<int>(f), pole, along_u, at_low};
          std::vector<Vec3> normals;
          const bool is_known = std::any_of(tip_.begin(), tip_.end(), [&](const Tip& t) { return t.point == pole; });
          for (const double part : {0.1, 0.35, 0.6, 0.85})
            if (norm(around(tip, part, 0) - pole) < at_tip * model_->size())
              normals.push_back(piece(tip.face)->normal(around(tip, part, beside * model_->size())));
          if (std::any_of(normals.begin(), normals.end(), [&](Vec3 n) { return dot(n, normals[0]) < tip_cosine; }))
            if (!is_known) tip_.push_back(tip);
        }
}

void CadBody::add_lines(double longest_error) {
  std::map<int, Vec3> corner;       // by vertex: where CAD surfaces put corners, the end of the last edge there
  std::map<int, int> n_ends;        // of lines at a vertex
  std::vector<std::size_t> chosen;  // edges
  for (std::size_t e = 0; e < model_->edges().size(); ++e) {
    const auto& edge = model_->edges()[e];
    const bool is_line = !model_->faces_of(static_cast<int>(e)).empty();  // no seam
    if (is_line) chosen.push_back(e);
    for (const std::size_t k : {0, 1}) {
      const int vertex = edge.data().vertex[k];
      if (vertex < 0) continue;
      corner[vertex] = k == 0 ? edge.points().front() : edge.points().back();
      n_ends[vertex] += is_line;
    }
  }
  for (const auto e : chosen) {
    const auto& edge = model_->edges()[e];
    const auto vertex = edge.data().vertex;
    Line line{static_cast<int>(e), model_->faces_of(static_cast<int>(e)), polyline_of(edge, longest_error)};
    if (vertex[0] >= 0) line.point.front() = corner[vertex[0]];
    if (vertex[1] >= 0) line.point.back() = corner[vertex[1]];
    const bool is_closed = line.point.front() == line.point.back();
    if (is_closed && vertex[0] >= 0 && n_ends[vertex[0]] > 2) {  // other lines end there: closed ones have no corner
      const auto middle = line.point.begin() + std::ssize(line.point) / 2;
      line_.push_back({line.edge, line.face, {middle, line.point.end()}});
      line.point.erase(middle + 1, line.point.end());
    }
    line_.push_back(std::move(line));
  }
}

}  // namespace pamr::meshing
