// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/decimate.hpp"

#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModHausdorffT.hh>
#include <algorithm>
#include <stdexcept>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/triangulated/self_intersection.hpp"
#include "pamr/geometry/triangulated/triangle_tree.hpp"
#include "surface_mesh/collapse_guard.hpp"
#include "surface_mesh/half_edges.hpp"
#include "surface_mesh/mend.hpp"
#include "surface_mesh/triangle_shape.hpp"

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

/// Old points where the result is not as it must be, marked. None: all is well. Sets what is measured.
std::vector<char> find_faults(const Triangulation& surface, const DecimateOptions& options, Decimated& result) {
  constexpr std::int64_t few_queries = 100'000;  // where nothing depends on the answer
  constexpr std::int64_t least_queries = 2'000'000, queries_of_triangle = 8;
  DistanceOptions how{.enough = options.error, .max_queries = few_queries};
  if (options.error > 0)
    how.max_queries = least_queries + queries_of_triangle * static_cast<std::int64_t>(surface.triangles.size());
  result.from_old = distance_from_to(surface, result.surface, how);
  result.to_old = distance_from_to(result.surface, surface, how);
  std::vector<char> is_wrong(surface.points.size(), 0);
  for (const auto* triangles : {&result.from_old.far_from, &result.to_old.far_to})
    for (const int t : *triangles)
      for (const int n : surface.triangles[at(t)]) is_wrong[at(n)] = 1;
  const bool has_cuts = geometry::find_self_intersections(result.surface, 1).n_pairs > 0;
  result.cuts_itself = has_cuts && geometry::find_self_intersections(surface, 1).n_pairs > 0;
  if (!has_cuts || result.cuts_itself) return is_wrong;
  std::vector<char> cuts(result.surface.triangles.size(), 0);
  for (const int t : cutting_triangles(result.surface)) cuts[at(t)] = 1;
  const geometry::TriangleTree tree(all_corners(result.surface));
  for (std::size_t n = 0; n < surface.points.size(); ++n)
    if (cuts[at(tree.nearest(surface.points[n]).triangle)] != 0) is_wrong[n] = 1;
  return is_wrong;
}

/// Marks the neighbors of marked points, and theirs, `n_rings` times.
void grow(std::vector<char>& is_marked, const Triangulation& surface, int n_rings) {
  for (int ring = 0; ring < n_rings; ++ring) {
    const auto before = is_marked;
    for (const auto& corner : surface.triangles)
      if (std::any_of(corner.begin(), corner.end(), [&](int n) { return before[at(n)] != 0; }))
        for (const int n : corner) is_marked[at(n)] = 1;
  }
}

}  // namespace

Decimated decimate(const Triangulation& surface, const DecimateOptions& options) {
  constexpr int max_rounds = 8;
  Decimated result;
  std::vector<char> is_fixed(surface.points.size(), 0);
  int n_rings = 0;
  for (result.n_rounds = 1;; ++result.n_rounds) {
    auto collapsed = collapse(surface, options, is_fixed);
    result.surface = std::move(collapsed.surface);
    result.n_sharp_edges = collapsed.n_sharp_edges;
    result.n_fixed = std::count(is_fixed.begin(), is_fixed.end(), char{1});
    result.from_old = result.to_old = {};
    if (result.n_fixed == std::ssize(is_fixed)) return result;  // the input itself
    auto is_wrong = find_faults(surface, options, result);
    if (std::none_of(is_wrong.begin(), is_wrong.end(), [](char wrong) { return wrong != 0; })) return result;
    grow(is_wrong, surface, n_rings);
    for (std::size_t n = 0; n < is_fixed.size(); ++n)
      if (is_wrong[n] != 0 || result.n_rounds >= max_rounds) is_fixed[n] = 1;
    n_rings = 2 * n_rings + 1;
  }
}

}  // namespace pamr::surface_mesh
