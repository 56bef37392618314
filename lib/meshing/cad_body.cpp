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
                                   std::clamp(longest_error / model.size(), finest, coarsest));
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

[[noreturn]] void refuse_open(const geometry::CadModel& model, std::int64_t n_open, Vec3 where, int face) {
  const auto& name = model.faces()[at(face)].data().name;
  throw Error(fmt::format(
      "expected a closed shape, found one that is open at {} places, the first near ({:.6g}, {:.6g}, {:.6g}) at face "
      "{}{}: sew it with gmsh part.step -setnumber Geometry.OCCSewFaces 1 -setnumber Geometry.OCCMakeSolids 1 "
      "-0 -o sewn.brep, and mesh sewn.brep; or export a solid",
      n_open, where.x, where.y, where.z, face + 1, name.empty() ? "" : " \"" + name + "\""));
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
    throw Error(
        fmt::format("expected one solid, or solids clear of one another, found {} of which {}: several materials in "
                    "one mesh are not "
                    "possible yet; unite the solids, cut the inner one out of the outer one, or export one of them",
                    n, pairs));
  }
  if (n == 0 || solids.loose_face.empty()) return;
  const auto& face = solids.loose_face.front();
  const bool is_one = solids.loose_face.size() == 1;
  throw Error(fmt::format(
      "expected solids alone, found {} solid{}, and {} face{} that belong{} to none, {}at {} (face {}): take "
      "{} out of the file",
      n, n == 1 ? "" : "s", solids.loose_face.size(), is_one ? "" : "s", is_one ? "s" : "", is_one ? "" : "the first ",
      geometry::decimal(face.where), face.face + 1, is_one ? "it" : "them"));
}

}  // namespace

CadBody::CadBody(std::shared_ptr<const geometry::CadModel> model, double longest_error)
    : model_(std::move(model)), faces_(model_, all_faces(*model_)) {
  const auto triangles = triangles_of(*model_, longest_error);
  require_solids(triangles.solids);
  volume_ = triangles.solids.volume;
  add_normals(triangles);
  find_tips();
  add_lines(longest_error);
}

void CadBody::add_normals(const geometry::CadTriangles& triangles) {
  point_ = triangles.point;
  corner_ = triangles.corner;
  face_ = triangles.face;
  vertex_normal_.resize(point_.size());
  side_normal_.resize(corner_.size());
  std::map<std::pair<int, int>, std::size_t> side;  // directed, with 3 t + the corner opposite
  std::vector<std::array<Vec3, 3>> soup;
  for (std::size_t t = 0; t < corner_.size(); ++t) {
    const auto p = [&](std::size_t k) { return point_[at(corner_[t][k % 3])]; };
    soup.push_back({p(0), p(1), p(2)});
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
  std::int64_t n_open = static_cast<std::int64_t>(3 * corner_.size() - side.size());  // two with one direction
  std::size_t first = 0;
  for (const auto& [ends, place] : side) {
    const auto other = side.find({ends.second, ends.first});
    if (other == side.end()) {
      if (n_open++ == 0) first = place;
      continue;
    }
    side_normal_[place / 3][place % 3] = normal_[place / 3] + normal_[other->second / 3];
  }
  if (n_open > 0) refuse_open(*model_, n_open, point_[at(corner_[first / 3][(first + 1) % 3])], face_[first / 3]);
  tree_ = std::make_unique<const geometry::TriangleTree>(soup);
}

double CadBody::signed_distance(Vec3 point) const {
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

std::vector<std::array<Vec3, 3>> CadBody::triangles() const {
  std::vector<std::array<Vec3, 3>> result;
  for (const auto& [a, b, c] : corner_) result.push_back({point_[at(a)], point_[at(b)], point_[at(c)]});
  return result;
}

int CadBody::piece_at(Vec3 point) const { return face_[at(tree_->nearest(point).triangle)]; }

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
