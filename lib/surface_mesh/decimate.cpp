// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/decimate.hpp"

#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModHausdorffT.hh>
#include <algorithm>
#include <stdexcept>
#include <vector>

#include "pamr/base/index.hpp"
#include "surface_mesh/collapse_guard.hpp"
#include "surface_mesh/half_edges.hpp"

namespace pamr::surface_mesh {

namespace {

using geometry::Triangulation;
using geometry::Vec3;
using Decimater = OpenMesh::Decimater::DecimaterT<HalfEdges>;

/// How coordinates are brought to a box of size 1, so that OpenMesh's single precision and fixed bounds fit all units.
struct Frame {
  Vec3 origin;
  double size = 1;
};

Frame frame_of(const Triangulation& surface) {
  Vec3 low = surface.points.front(), high = low;
  for (const auto& corner : surface.triangles)
    for (const int n : corner) {
      const Vec3 p = surface.points[at(n)];
      low = {std::min(low.x, p.x), std::min(low.y, p.y), std::min(low.z, p.z)};
      high = {std::max(high.x, p.x), std::max(high.y, p.y), std::max(high.z, p.z)};
    }
  return {low, norm(high - low)};
}

struct Collapsed {
  Triangulation surface;
  std::int64_t n_sharp_edges = 0;
};

/// One decimation; `is_fixed` says which points stay in any case.
Collapsed collapse(const Triangulation& surface, const DecimateOptions& options, const std::vector<char>& is_fixed) {
  // Removed points are held to less than the error, which what lies between them should keep.
  constexpr double tolerance_part = 0.8;
  const double tolerance = tolerance_part * options.error;
  const auto frame = frame_of(surface);
  auto mesh = to_half_edges(surface);
  for (const auto v : mesh.vertices()) {
    const Vec3 p = (1 / frame.size) * (surface.points[at(v.idx())] - frame.origin);
    mesh.set_point(v, {p.x, p.y, p.z});
  }
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_face_status();
  mesh.request_face_normals();
  mesh.update_face_normals();
  for (const auto v : mesh.vertices()) mesh.status(v).set_locked(is_fixed[at(v.idx())] != 0);
  Collapsed result;
  result.n_sharp_edges = static_cast<std::int64_t>(mark_features(mesh, options.feature_angle));
  {
    Decimater decimater(mesh);
    QuadricOrderT<HalfEdges>::Handle order;
    CollapseGuardT<HalfEdges>::Handle guard;
    OpenMesh::Decimater::ModHausdorffT<HalfEdges>::Handle distance;
    decimater.add(order);
    decimater.add(guard);
    if (tolerance > 0) {
      decimater.add(distance);
      decimater.module(distance).set_tolerance(tolerance / frame.size);
      decimater.module(guard).set_line_tolerance(tolerance / frame.size);
    }
    if (!decimater.initialize()) throw std::logic_error("OpenMesh could not set up the decimation");
    decimater.decimate_to_faces(0, static_cast<std::size_t>(options.n_triangles));
  }
  // Points have their numbers still: deleted ones are not taken away by OpenMesh.
  std::vector<int> new_number(surface.points.size(), -1);
  for (int n = 0; n < std::ssize(surface.points); ++n) {
    const auto v = mesh.vertex_handle(static_cast<unsigned>(n));
    if (mesh.status(v).deleted() || mesh.is_isolated(v)) continue;
    new_number[at(n)] = static_cast<int>(result.surface.points.size());
    result.surface.points.push_back(surface.points[at(n)]);
  }
  for (const auto f : mesh.faces()) {
    std::array<int, 3> corner{};
    auto v = mesh.cfv_iter(f);
    for (int& n : corner) n = new_number[at((v++)->idx())];
    result.surface.triangles.push_back(corner);
  }
  return result;
}

}  // namespace

Decimated decimate(const Triangulation& surface, const DecimateOptions& options) {
  constexpr int max_rounds = 10;
  constexpr std::int64_t few_queries = 100'000;  // where nothing depends on the answer
  DistanceOptions how{.enough = options.error};
  if (options.error <= 0) how.max_queries = few_queries;
  Decimated result;
  std::vector<char> is_fixed(surface.points.size(), 0);
  for (result.n_rounds = 1;; ++result.n_rounds) {
    auto collapsed = collapse(surface, options, is_fixed);
    result.surface = std::move(collapsed.surface);
    result.n_sharp_edges = collapsed.n_sharp_edges;
    result.from_old = distance_from_to(surface, result.surface, how);
    result.to_old = distance_from_to(result.surface, surface, how);
    result.is_within = result.from_old.far_from.empty() && result.to_old.far_to.empty();
    if (result.is_within || result.n_rounds == max_rounds) return result;
    for (const auto* triangles : {&result.from_old.far_from, &result.to_old.far_to})
      for (const int t : *triangles)
        for (const int n : surface.triangles[at(t)]) is_fixed[at(n)] = 1;
  }
}

}  // namespace pamr::surface_mesh
