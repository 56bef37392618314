// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Surface_mesh.h>

#include <stdexcept>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::surface_mesh {

using CgalKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CgalMesh = CGAL::Surface_mesh<CgalKernel::Point_3>;

/// Points and triangles keep their numbers. Pre: a manifold of one orientation, closed or not. Local; O(n).
inline CgalMesh to_cgal(const geometry::Triangulation& surface) {
  CgalMesh mesh;
  for (const auto p : surface.points) mesh.add_vertex({p.x, p.y, p.z});
  const auto vertex = [](int n) { return CgalMesh::Vertex_index(static_cast<CgalMesh::size_type>(n)); };
  for (const auto& [a, b, c] : surface.triangles)
    if (mesh.add_face(vertex(a), vertex(b), vertex(c)) == CgalMesh::null_face())
      throw std::logic_error("CGAL refused a triangle of a manifold");
  return mesh;
}

/// What is not removed, in order. Points that no triangle uses are left out. Local; O(n).
inline geometry::Triangulation from_cgal(const CgalMesh& mesh) {
  geometry::Triangulation surface;
  std::vector<int> number(mesh.num_vertices() + mesh.number_of_removed_vertices(), -1);
  for (const auto v : mesh.vertices()) {
    if (mesh.is_isolated(v)) continue;
    number[at(v.idx())] = static_cast<int>(surface.points.size());
    const auto& p = mesh.point(v);
    surface.points.push_back({p.x(), p.y(), p.z()});
  }
  for (const auto f : mesh.faces()) {
    const auto h = mesh.halfedge(f);
    const auto n = [&](CgalMesh::Halfedge_index half) { return number[at(mesh.target(half).idx())]; };
    surface.triangles.push_back({n(mesh.prev(h)), n(h), n(mesh.next(h))});
  }
  return surface;
}

}  // namespace pamr::surface_mesh
