// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/half_edges.hpp"

#include <cmath>
#include <numbers>
#include <stdexcept>

#include "pamr/base/index.hpp"

namespace pamr::surface_mesh {

using geometry::Triangulation;

namespace {

/// The third point of the triangle of a half-edge, if it has one.
HalfEdges::VertexHandle opposite_point(const HalfEdges& mesh, HalfEdges::HalfedgeHandle h) {
  return mesh.is_boundary(h) ? HalfEdges::VertexHandle() : mesh.to_vertex_handle(mesh.next_halfedge_handle(h));
}

/// Whether the triangle of a half-edge is joined to others by that edge only.
bool hangs_alone(const HalfEdges& mesh, HalfEdges::HalfedgeHandle h) {
  if (mesh.is_boundary(h)) return false;
  const auto next = mesh.next_halfedge_handle(h), last = mesh.next_halfedge_handle(next);
  return mesh.is_boundary(mesh.opposite_halfedge_handle(next)) && mesh.is_boundary(mesh.opposite_halfedge_handle(last));
}

}  // namespace

bool HalfEdges::is_collapse_ok(HalfedgeHandle h) const {
  const auto back = opposite_halfedge_handle(h);
  const auto from = to_vertex_handle(back), to = to_vertex_handle(h);
  if (status(edge_handle(h)).deleted() || status(from).deleted() || status(to).deleted()) return false;
  if (hangs_alone(*this, h) || hangs_alone(*this, back)) return false;
  const auto left = opposite_point(*this, h), right = opposite_point(*this, back);
  if (left == right) return false;
  if (is_boundary(from) && is_boundary(to) && !is_boundary(h) && !is_boundary(back)) return false;
  // Only the two opposite points may be neighbors of both ends.
  for (auto a = cvv_iter(from); a.is_valid(); ++a) {
    if (*a == left || *a == right || *a == to) continue;
    for (auto b = cvv_iter(to); b.is_valid(); ++b)
      if (*a == *b) return false;
  }
  return true;
}

HalfEdges to_half_edges(const Triangulation& surface) {
  omerr().disable();  // failures are found below
  HalfEdges mesh;
  mesh.reserve(surface.points.size(), surface.points.size() + surface.triangles.size(), surface.triangles.size());
  for (const auto p : surface.points) mesh.add_vertex({p.x, p.y, p.z});
  for (const auto& [a, b, c] : surface.triangles)
    if (!mesh.add_face(mesh.vertex_handle(static_cast<unsigned>(a)), mesh.vertex_handle(static_cast<unsigned>(b)),
                       mesh.vertex_handle(static_cast<unsigned>(c)))
             .is_valid())
      throw std::logic_error("OpenMesh refused a triangle of a valid surface");
  return mesh;
}

Triangulation to_triangulation(const HalfEdges& mesh) {
  Triangulation surface;
  surface.points.reserve(mesh.n_vertices());
  surface.triangles.reserve(mesh.n_faces());
  for (const auto v : mesh.vertices()) {
    const auto& p = mesh.point(v);
    surface.points.push_back({p[0], p[1], p[2]});
  }
  for (const auto f : mesh.faces()) {
    auto corner = mesh.cfv_iter(f);
    std::array<int, 3> n{};
    for (int& number : n) number = (corner++)->idx();
    surface.triangles.push_back(n);
  }
  return surface;
}

std::size_t mark_features(HalfEdges& mesh, double feature_angle) {
  const double cosine = feature_angle < 180 ? std::cos(feature_angle * std::numbers::pi / 180) : -2;
  std::size_t n = 0;
  for (const auto e : mesh.edges()) {
    if (mesh.is_boundary(e)) continue;
    const auto one = mesh.face_handle(mesh.halfedge_handle(e, 0)), other = mesh.face_handle(mesh.halfedge_handle(e, 1));
    if (!((mesh.normal(one) | mesh.normal(other)) < cosine)) continue;
    mesh.status(e).set_feature(true);
    mesh.status(mesh.to_vertex_handle(mesh.halfedge_handle(e, 0))).set_feature(true);
    mesh.status(mesh.to_vertex_handle(mesh.halfedge_handle(e, 1))).set_feature(true);
    ++n;
  }
  return n;
}

}  // namespace pamr::surface_mesh
