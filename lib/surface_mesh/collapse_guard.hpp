// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <OpenMesh/Tools/Decimater/ModBaseT.hh>
#include <OpenMesh/Tools/Decimater/ModQuadricT.hh>
#include <algorithm>
#include <array>
#include <vector>

namespace pamr::surface_mesh {

/// The quadric error as the order of collapses. OpenMesh takes an error below zero, which rounding makes on planes, for
/// a collapse that is not allowed.
template <class MeshT>
class QuadricOrderT : public OpenMesh::Decimater::ModQuadricT<MeshT> {
 public:
  using Handle = OpenMesh::Decimater::ModHandleT<QuadricOrderT<MeshT>>;
  using Parent = OpenMesh::Decimater::ModQuadricT<MeshT>;
  using typename Parent::CollapseInfo;

  explicit QuadricOrderT(MeshT& mesh) : Parent(mesh) {}

  /// Where the errors are all the same, short edges go first.
  float collapse_priority(const CollapseInfo& info) override {
    constexpr double weight = 1e-12;
    return std::max(0.0F, Parent::collapse_priority(info)) + static_cast<float>(weight * (info.p1 - info.p0).sqrnorm());
  }
};

/// Which collapses are allowed: those that keep sharp edges and the ends of open surfaces where they are, turn no
/// triangle over, and make none flat. Feature edges and points must be marked. Sharp edges and ends carry the points
/// that they have lost, to know how far they have moved.
template <class MeshT>
class CollapseGuardT : public OpenMesh::Decimater::ModBaseT<MeshT> {
 public:
  using Handle = OpenMesh::Decimater::ModHandleT<CollapseGuardT<MeshT>>;
  using Base = OpenMesh::Decimater::ModBaseT<MeshT>;
  using typename Base::CollapseInfo;
  using Point = typename MeshT::Point;
  using Edge = typename MeshT::EdgeHandle;
  using Vertex = typename MeshT::VertexHandle;

  explicit CollapseGuardT(MeshT& mesh) : Base(mesh, true) { mesh.add_property(lost_); }
  ~CollapseGuardT() override { this->mesh().remove_property(lost_); }
  CollapseGuardT(const CollapseGuardT&) = delete;
  CollapseGuardT& operator=(const CollapseGuardT&) = delete;
  CollapseGuardT(CollapseGuardT&&) = delete;
  CollapseGuardT& operator=(CollapseGuardT&&) = delete;

  const std::string& name() const override {
    static const std::string text = "CollapseGuard";
    return text;
  }

  /// Largest distance of a removed point from the sharp edge or end in its place; negative: no bound for sharp edges,
  /// and ends stay as they are.
  void set_line_tolerance(double tolerance) { tolerance_ = tolerance; }

  float collapse_priority(const CollapseInfo& info) override {
    const bool is_allowed = keeps_lines(info) && keeps_shapes(info);
    return static_cast<float>(is_allowed ? Base::LEGAL_COLLAPSE : Base::ILLEGAL_COLLAPSE);
  }

  void preprocess_collapse(const CollapseInfo& info) override {
    auto& mesh = this->mesh();
    left_is_line_ =
        info.vl.is_valid() && (is_line(edge_between(info.v0, info.vl)) || is_line(edge_between(info.v1, info.vl)));
    right_is_line_ =
        info.vr.is_valid() && (is_line(edge_between(info.v0, info.vr)) || is_line(edge_between(info.v1, info.vr)));
    carried_.clear();
    other_ = Vertex();
    const auto own = mesh.edge_handle(info.v0v1);
    if (!is_line(own)) return;
    other_ = other_end(info.v0, own);
    if (!other_.is_valid()) return;
    const auto old = edge_between(info.v0, other_);
    for (const auto e : {own, old}) {
      carried_.insert(carried_.end(), mesh.property(lost_, e).begin(), mesh.property(lost_, e).end());
      mesh.property(lost_, e).clear();
    }
    carried_.push_back(info.p0);
  }

  void postprocess_collapse(const CollapseInfo& info) override {
    auto& mesh = this->mesh();
    // Of two edges that became one, OpenMesh keeps the status of either.
    const auto restore = [&](Vertex v, bool was_line) {
      if (!v.is_valid()) return;
      const auto e = edge_between(info.v1, v);
      if (e.is_valid() && was_line && !mesh.is_boundary(e)) mesh.status(e).set_feature(true);
    };
    restore(info.vl, left_is_line_);
    restore(info.vr, right_is_line_);
    if (!other_.is_valid()) return;
    const auto e = edge_between(info.v1, other_);
    if (!e.is_valid()) return;
    auto& lost = mesh.property(lost_, e);
    lost.insert(lost.end(), carried_.begin(), carried_.end());
  }

 private:
  /// A sharp edge, or one at the end of an open surface.
  bool is_line(Edge e) { return e.is_valid() && (this->mesh().status(e).feature() || this->mesh().is_boundary(e)); }
  Edge edge_between(Vertex a, Vertex b) {
    const auto h = this->mesh().find_halfedge(a, b);
    return h.is_valid() ? this->mesh().edge_handle(h) : Edge();
  }

  /// The other point of the other line at a point that exactly two lines meet in; none if there are more or fewer.
  Vertex other_end(Vertex v, Edge own) {
    auto& mesh = this->mesh();
    Vertex found;
    int n = 0;
    for (auto h = mesh.voh_iter(v); h.is_valid(); ++h) {
      const auto e = mesh.edge_handle(*h);
      if (!is_line(e)) continue;
      ++n;
      if (e != own) found = mesh.to_vertex_handle(*h);
    }
    return n == 2 ? found : Vertex();
  }

  bool keeps_lines(const CollapseInfo& info) {
    auto& mesh = this->mesh();
    if (!mesh.status(info.v0).feature() && !mesh.is_boundary(info.v0)) return true;
    const auto own = mesh.edge_handle(info.v0v1);
    if (!is_line(own)) return false;
    if (tolerance_ < 0 && mesh.is_boundary(info.v0)) return false;
    const auto other = other_end(info.v0, own);
    if (!other.is_valid()) return false;
    const auto joined = edge_between(info.v1, other);
    if (joined.is_valid() && is_line(joined)) return false;  // two lines would become one
    if (tolerance_ < 0) return true;
    const auto& a = mesh.point(other);
    const auto near = [&](const Point& p) { return distance_from_segment(p, a, info.p1) <= tolerance_; };
    if (!near(info.p0)) return false;
    for (const auto e : {own, edge_between(info.v0, other)})
      for (const auto& p : mesh.property(lost_, e))
        if (!near(p)) return false;
    return true;
  }

  static double distance_from_segment(const Point& p, const Point& a, const Point& b) {
    const auto ab = b - a, ap = p - a;
    const double length = ab.sqrnorm(), along = length > 0 ? std::clamp((ap | ab) / length, 0.0, 1.0) : 0.0;
    return (ap - ab * along).norm();
  }

  /// The hottest function of a decimation: squares, and what was there before only where it matters.
  bool keeps_shapes(const CollapseInfo& info) {
    constexpr double min_height = 0.05, min_cosine = 0.5;
    auto& mesh = this->mesh();
    double worst_after = 1;
    for (auto h = mesh.voh_iter(info.v0); h.is_valid(); ++h) {
      const auto f = mesh.face_handle(*h);
      if (!f.is_valid() || f == info.fl || f == info.fr) continue;
      const auto b = mesh.point(mesh.to_vertex_handle(*h)) - info.p1;
      const auto c = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(*h))) - info.p1;
      const auto normal = b % c;
      const double along = normal | mesh.normal(f), size = normal.sqrnorm();
      if (!(along > 0 && along * along > min_cosine * min_cosine * size)) return false;
      worst_after = std::min(worst_after, squared_height(size, b, c));
    }
    return worst_after > min_height * min_height || worst_after > worst_before(info);
  }

  double worst_before(const CollapseInfo& info) {
    auto& mesh = this->mesh();
    double worst = 1;
    for (auto h = mesh.voh_iter(info.v0); h.is_valid(); ++h) {
      if (!mesh.face_handle(*h).is_valid()) continue;
      const auto b = mesh.point(mesh.to_vertex_handle(*h)) - info.p0;
      const auto c = mesh.point(mesh.to_vertex_handle(mesh.next_halfedge_handle(*h))) - info.p0;
      worst = std::min(worst, squared_height((b % c).sqrnorm(), b, c));
    }
    return worst;
  }

  /// Of the triangle 0, b, c: height over the longest side, as a part of it, squared.
  static double squared_height(double squared_normal, const Point& b, const Point& c) {
    const double longest = std::max({b.sqrnorm(), c.sqrnorm(), (c - b).sqrnorm()});
    return longest > 0 ? squared_normal / (longest * longest) : 0;
  }

  OpenMesh::EPropHandleT<std::vector<Point>> lost_;
  double tolerance_ = -1;
  bool left_is_line_ = false, right_is_line_ = false;
  Vertex other_;
  std::vector<Point> carried_;
};

}  // namespace pamr::surface_mesh
