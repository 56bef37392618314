// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/smooth_surface.hpp"

#include <OpenMesh/Tools/Smoother/JacobiLaplaceSmootherT.hh>
#include <algorithm>

#include "surface_mesh/half_edges.hpp"

namespace pamr::surface_mesh {

namespace {

/// OpenMesh's smoother with a part of the way to the mean of the neighbors that may be negative.
class BothWays : public OpenMesh::Smoother::JacobiLaplaceSmootherT<HalfEdges> {
 public:
  explicit BothWays(HalfEdges& mesh) : JacobiLaplaceSmootherT(mesh) {}

  void step(double part) {
    part_ = part;
    smooth(1);
  }

 protected:
  void compute_new_positions_C0() override {
    for (const auto v : mesh_.vertices()) {
      if (!is_active(v)) continue;
      HalfEdges::Point sum(0, 0, 0);
      for (auto h = mesh_.cvoh_iter(v); h.is_valid(); ++h)
        sum += weight(mesh_.edge_handle(*h)) * mesh_.point(mesh_.to_vertex_handle(*h));
      const auto here = mesh_.point(v);
      set_new_position(v, here + part_ * (weight(v) * sum - here));
    }
  }

 private:
  double part_ = 0;
};

}  // namespace

Smoothed smooth(const geometry::Triangulation& surface, const SmoothOptions& options) {
  // Waves longer than some 30 edges keep their height: 1 / there + 1 / back = 0.047.
  constexpr double there = 0.5, back = -0.512;
  auto mesh = to_half_edges(surface);
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_face_status();
  mesh.request_face_normals();
  mesh.update_face_normals();
  mark_features(mesh, options.feature_angle);
  BothWays smoother(mesh);
  smoother.initialize(BothWays::Tangential_and_Normal, BothWays::C0);
  smoother.skip_features(true);
  if (options.max_move > 0) smoother.set_absolute_local_error(options.max_move);
  for (int i = 0; i < options.n_steps; ++i) {
    smoother.step(there);
    smoother.step(back);
  }
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
