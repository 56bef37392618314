// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/smooth_surface.hpp"

#include <OpenMesh/Tools/Smoother/JacobiLaplaceSmootherT.hh>
#include <algorithm>

#include "surface_mesh/half_edges.hpp"

namespace pamr::surface_mesh {

Smoothed smooth(const geometry::Triangulation& surface, const SmoothOptions& options) {
  using Smoother = OpenMesh::Smoother::JacobiLaplaceSmootherT<HalfEdges>;
  auto mesh = to_half_edges(surface);
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_face_status();
  mesh.request_face_normals();
  mesh.update_face_normals();
  mark_features(mesh, options.feature_angle);
  Smoother smoother(mesh);
  smoother.initialize(Smoother::Tangential_and_Normal, Smoother::C0);
  smoother.skip_features(true);
  if (options.max_move > 0) smoother.set_absolute_local_error(options.max_move);
  smoother.smooth(static_cast<unsigned>(options.n_steps));
  Smoothed result{.surface = to_triangulation(mesh)};
  double sum = 0;
  for (std::size_t i = 0; i < surface.points.size(); ++i) {
    const double move = norm(result.surface.points[i] - surface.points[i]);
    if (move == 0) ++result.n_fixed;
    sum += move;
    result.worst_move = std::max(result.worst_move, move);
  }
  result.mean_move = sum / static_cast<double>(surface.points.size());
  return result;
}

}  // namespace pamr::surface_mesh
