// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/decimate.hpp"

#include <OpenMesh/Tools/Decimater/DecimaterT.hh>
#include <OpenMesh/Tools/Decimater/ModHausdorffT.hh>
#include <algorithm>
#include <array>
#include <iterator>
#include <numeric>
#include <stdexcept>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/triangulated/self_intersection.hpp"
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
  geometry::Box box{surface.points.front(), surface.points.front()};
  for (const auto& corner : surface.triangles)
    for (const int n : corner) box.extend(surface.points[at(n)]);
  return {box.low, box.diagonal()};
}

struct Collapsed {
  Triangulation surface;
  std::vector<int> new_to_old;   // points
  std::vector<char> is_removed;  // old points
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
  result.is_removed.assign(surface.points.size(), 1);
  for (int n = 0; n < std::ssize(surface.points); ++n) {
    const auto v = mesh.vertex_handle(static_cast<unsigned>(n));
    if (mesh.status(v).deleted() || mesh.is_isolated(v)) continue;
    new_number[at(n)] = static_cast<int>(result.surface.points.size());
    result.is_removed[at(n)] = 0;
    result.new_to_old.push_back(n);
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

bool is_closed(const Triangulation& surface) {
  const auto mesh = to_half_edges(surface);
  return std::none_of(mesh.edges_begin(), mesh.edges_end(), [&](auto edge) { return mesh.is_boundary(edge); });
}

double volume_of(const Triangulation& surface) {
  const Vec3 origin = surface.points.front();
  double sum = 0;
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto p = corners_of(surface, t);
    sum += dot(p[0] - origin, cross(p[1] - origin, p[2] - origin)) / 6;
  }
  return sum;
}

/// Where something is wrong: a point and the old triangle or the corners there.
struct Place {
  Vec3 point;
  std::array<int, 3> corner{};  // old points
};

Place place_of(const Collapsed& collapsed, std::size_t t) {
  const auto p = corners_of(collapsed.surface, t);
  auto corner = collapsed.surface.triangles[t];
  for (int& n : corner) n = collapsed.new_to_old[at(n)];
  return {(1.0 / 3) * (p[0] + p[1] + p[2]), corner};
}

/// Where the result is not as it must be. Sets what is measured.
std::vector<Place> find_faults(const Triangulation& surface, const DecimateOptions& options, const Collapsed& collapsed,
                               Decimated& result) {
  constexpr std::int64_t few_queries = 100'000;  // where nothing depends on the answer
  constexpr std::int64_t min_queries = 2'000'000, queries_of_triangle = 8;
  const auto& after = collapsed.surface;
  DistanceOptions how{.enough = options.error, .max_queries = few_queries};
  if (options.error > 0)
    how.max_queries = min_queries + queries_of_triangle * static_cast<std::int64_t>(surface.triangles.size());
  result.from_old = distance_from_to(surface, after, how);
  result.to_old = distance_from_to(after, surface, how);
  std::vector<Place> places;
  // An error as large as the body allows a surface that is turned inside out.
  if (!(volume_of(after) > 0) && volume_of(surface) > 0 && is_closed(surface))
    for (std::size_t t = 0; t < after.triangles.size(); ++t) places.push_back(place_of(collapsed, t));
  for (const auto& far : result.from_old.far) places.push_back({far.point, surface.triangles[at(far.from)]});
  for (const auto& far : result.to_old.far) places.push_back({far.point, surface.triangles[at(far.to)]});
  const bool has_cuts = geometry::cuts_itself(after);
  result.cuts_itself = has_cuts && geometry::cuts_itself(surface);
  if (!has_cuts || result.cuts_itself) return places;
  for (const int t : cutting_triangles(after)) places.push_back(place_of(collapsed, at(t)));
  return places;
}

/// Finds removed points to fix, over the triangles of the old surface.
class Fixer {
 public:
  explicit Fixer(const Triangulation& surface) : surface_(surface), first_(surface.points.size() + 1, 0) {
    for (const auto& corner : surface.triangles)
      for (const int n : corner) ++first_[at(n) + 1];
    std::partial_sum(first_.begin(), first_.end(), first_.begin());
    triangles_.resize(at(first_.back()));
    auto next = first_;
    for (int t = 0; t < std::ssize(surface.triangles); ++t)
      for (const int n : surface.triangles[at(t)]) triangles_[at(next[at(n)]++)] = t;
    is_seen_.assign(surface.points.size(), 0);
  }

  /// Fixes the removed point next to a place, or all that are no more than `n_rings` rings farther.
  void fix(const Place& place, const std::vector<char>& is_removed, int n_rings, std::vector<char>& is_fixed) {
    std::vector<int> ring(place.corner.begin(), place.corner.end()), seen = ring;
    for (const int n : ring) is_seen_[at(n)] = 1;
    for (int left = -1; left != 0 && !ring.empty();) {
      std::vector<int> removed;
      std::copy_if(ring.begin(), ring.end(), std::back_inserter(removed),
                   [&](int n) { return is_removed[at(n)] != 0; });
      if (left < 0 && !removed.empty()) {
        left = n_rings + 1;
        const auto distance = [&](int n) { return norm(surface_.points[at(n)] - place.point); };
        is_fixed[at(*std::min_element(removed.begin(), removed.end(),
                                      [&](int a, int b) { return distance(a) < distance(b); }))] = 1;
      }
      if (left > 0 && n_rings > 0)
        for (const int n : removed) is_fixed[at(n)] = 1;
      if (left > 0) --left;
      ring = next_ring(ring);
      seen.insert(seen.end(), ring.begin(), ring.end());
    }
    for (const int n : seen) is_seen_[at(n)] = 0;
  }

 private:
  std::vector<int> next_ring(const std::vector<int>& ring) {
    std::vector<int> next;
    for (const int n : ring)
      for (int i = first_[at(n)]; i < first_[at(n) + 1]; ++i)
        for (const int other : surface_.triangles[at(triangles_[at(i)])]) {
          if (is_seen_[at(other)] != 0) continue;
          is_seen_[at(other)] = 1;
          next.push_back(other);
        }
    return next;
  }

  const Triangulation& surface_;
  std::vector<int> first_, triangles_;  // of each point
  std::vector<char> is_seen_;
};

}  // namespace

Decimated decimate(const Triangulation& surface, const DecimateOptions& options) {
  // As few points as possible are fixed in the first rounds: they leave triangles as small as they were.
  constexpr int single_rounds = 12, max_rounds = 20;
  Decimated result;
  std::vector<char> is_fixed(surface.points.size(), 0);
  int n_rings = 0;
  for (result.n_rounds = 1;; ++result.n_rounds) {
    auto collapsed = collapse(surface, options, is_fixed);
    result.n_sharp_edges = collapsed.n_sharp_edges;
    result.n_fixed = std::count(is_fixed.begin(), is_fixed.end(), char{1});
    result.from_old = result.to_old = {};
    const bool is_input = result.n_fixed == std::ssize(is_fixed);
    const auto places = is_input ? std::vector<Place>() : find_faults(surface, options, collapsed, result);
    if (places.empty()) {
      result.surface = std::move(collapsed.surface);
      return result;
    }
    if (result.n_rounds > single_rounds) n_rings = 2 * n_rings + 1;
    Fixer fixer(surface);
    for (const auto& place : places) fixer.fix(place, collapsed.is_removed, n_rings, is_fixed);
    if (result.n_rounds == max_rounds) std::fill(is_fixed.begin(), is_fixed.end(), char{1});
  }
}

}  // namespace pamr::surface_mesh
