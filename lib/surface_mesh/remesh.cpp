// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/remesh.hpp"

#include <CGAL/Polygon_mesh_processing/remesh.h>

#include <cmath>
#include <numbers>

#include "surface_mesh/cgal_mesh.hpp"

namespace pamr::surface_mesh {

Remeshed remesh(const geometry::Triangulation& surface, const RemeshOptions& options) {
  Remeshed result;
  auto mesh = to_cgal(surface);
  auto is_sharp = mesh.add_property_map<CgalMesh::Edge_index, bool>("e:is_sharp", false).first;
  const double cosine = options.feature_angle < 180 ? std::cos(options.feature_angle * std::numbers::pi / 180) : -2;
  const auto normal_of = [&](CgalMesh::Halfedge_index h) {
    const auto p = [&](CgalMesh::Halfedge_index half) {
      const auto& x = mesh.point(mesh.target(half));
      return geometry::Vec3{x.x(), x.y(), x.z()};
    };
    const auto a = p(h);
    const auto normal = cross(p(mesh.next(h)) - a, p(mesh.prev(h)) - a);
    return (1 / norm(normal)) * normal;
  };
  for (const auto e : mesh.edges()) {
    if (mesh.is_border(e)) continue;
    const auto h = mesh.halfedge(e);
    if (!(dot(normal_of(h), normal_of(mesh.opposite(h))) < cosine)) continue;
    is_sharp[e] = true;
    ++result.n_sharp_edges;
  }
  CGAL::Polygon_mesh_processing::isotropic_remeshing(mesh.faces(), options.size, mesh,
                                                     CGAL::parameters::number_of_iterations(options.n_steps)
                                                         .edge_is_constrained_map(is_sharp)
                                                         .protect_constraints(false));
  result.surface = from_cgal(mesh);
  return result;
}

}  // namespace pamr::surface_mesh
