// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/clean.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/triangulated/check_triangulation.hpp"
#include "pamr/geometry/triangulated/edge_table.hpp"
#include "pamr/geometry/triangulated/groups.hpp"
#include "pamr/geometry/triangulated/shells.hpp"
#include "surface_mesh/half_edges.hpp"
#include "surface_mesh/triangle_shape.hpp"

namespace pamr::surface_mesh {

namespace {

using geometry::Triangulation;
using geometry::Vec3;

/// Collapses or flips one flat triangle away; false if neither is possible.
bool mend_one(HalfEdges& mesh, HalfEdges::FaceHandle f, MendedFlat& done) {
  std::array<HalfEdges::HalfedgeHandle, 3> side;
  auto around = mesh.fh_iter(f);
  for (auto& h : side) h = *around++;
  std::sort(side.begin(), side.end(),
            [&](auto a, auto b) { return mesh.calc_edge_sqr_length(a) < mesh.calc_edge_sqr_length(b); });
  constexpr double needle = 1e-5;  // of the longest edge
  const bool is_needle = !(mesh.calc_edge_sqr_length(side[0]) > needle * needle * mesh.calc_edge_sqr_length(side[2]));
  if (!is_needle && !mesh.is_boundary(mesh.edge_handle(side[2])) && mesh.is_flip_ok(mesh.edge_handle(side[2]))) {
    mesh.flip(mesh.edge_handle(side[2]));
    ++done.n_flipped;
    return true;
  }
  for (const auto h : {side[0], mesh.opposite_halfedge_handle(side[0])})
    if (is_needle && mesh.is_collapse_ok(h)) {
      mesh.collapse(h);
      ++done.n_collapsed;
      return true;
    }
  return false;
}

}  // namespace

std::int64_t drop_unused(Triangulation& surface) {
  const auto n = std::ssize(surface.points);
  geometry::drop_unused_points(surface);
  return n - std::ssize(surface.points);
}

std::int64_t weld(Triangulation& surface, double distance) {
  std::vector<int> order(surface.points.size());
  std::iota(order.begin(), order.end(), 0);
  const auto point = [&](int n) { return surface.points[at(n)]; };
  std::sort(order.begin(), order.end(), [&](int a, int b) {
    return point(a) == point(b) ? a < b : geometry::lexicographically_less(point(a), point(b));
  });
  geometry::Groups groups(order.size());
  for (std::size_t i = 0; i < order.size(); ++i)
    for (auto j = i + 1; j < order.size() && point(order[j]).x - point(order[i]).x <= distance; ++j)
      if (norm(point(order[j]) - point(order[i])) <= distance) groups.join(order[i], order[j]);
  std::int64_t n = 0;
  for (int i = 0; i < std::ssize(order); ++i)
    if (groups.of(i) != i) ++n;
  if (n == 0) return 0;
  for (auto& corner : surface.triangles)
    for (int& p : corner) p = groups.of(p);
  geometry::drop_unused_points(surface);
  return n;
}

std::int64_t drop_collapsed(Triangulation& surface) {
  return static_cast<std::int64_t>(
      std::erase_if(surface.triangles, [](const auto& n) { return n[0] == n[1] || n[1] == n[2] || n[2] == n[0]; }));
}

std::int64_t drop_duplicates(Triangulation& surface) {
  std::vector<std::array<int, 4>> rows;  // sorted corners, triangle
  for (int t = 0; t < std::ssize(surface.triangles); ++t) {
    auto n = surface.triangles[at(t)];
    std::sort(n.begin(), n.end());
    rows.push_back({n[0], n[1], n[2], t});
  }
  std::sort(rows.begin(), rows.end());
  std::vector<char> is_again(rows.size(), 0);
  for (std::size_t i = 1; i < rows.size(); ++i)
    if (std::equal(rows[i].begin(), rows[i].begin() + 3, rows[i - 1].begin())) is_again[at(rows[i][3])] = 1;
  std::size_t t = 0;
  return static_cast<std::int64_t>(std::erase_if(surface.triangles, [&](const auto&) { return is_again[t++] != 0; }));
}

DroppedShells drop_small_shells(Triangulation& surface, double min_area) {
  constexpr double small_open_part = 0.01;
  if (surface.triangles.empty()) return {};
  const auto shells = geometry::find_shells(surface);
  double total = 0;
  for (const auto& shell : shells.shell) total += shell.area;
  std::vector<char> goes;
  DroppedShells done;
  for (const auto& shell : shells.shell) {
    const bool is_small = shell.area < min_area || (!shell.is_closed && shell.area < small_open_part * total);
    goes.push_back(is_small ? 1 : 0);
    if (is_small) ++done.n_shells;
  }
  std::size_t t = 0;
  done.n_triangles = static_cast<std::int64_t>(
      std::erase_if(surface.triangles, [&](const auto&) { return goes[at(shells.of_triangle[t++])] != 0; }));
  if (done.n_triangles > 0) geometry::drop_unused_points(surface);
  return done;
}

TurnedShells turn_shells(Triangulation& surface) {
  TurnedShells done;
  if (surface.triangles.empty()) return done;
  auto shells = geometry::find_shells(surface);
  if (shells.shell.size() > 1) geometry::nest_shells(surface, shells);
  std::vector<char> turns(shells.shell.size(), 0);
  for (const int i : geometry::turned_shells(shells)) {
    turns[at(i)] = 1;
    ++(shells.shell[at(i)].depth % 2 == 1 ? done.n_inwards : done.n_outwards);
  }
  for (std::size_t t = 0; t < surface.triangles.size(); ++t)
    if (turns[at(shells.of_triangle[t])] != 0) std::swap(surface.triangles[t][1], surface.triangles[t][2]);
  return done;
}

MendedFlat mend_flat(Triangulation& surface) {
  constexpr int max_rounds = 20;
  MendedFlat done;
  const auto count = [&] {
    std::int64_t n = 0;
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) n += is_flat(corners_of(surface, t)) ? 1 : 0;
    return n;
  };
  done.n_left = count();
  if (done.n_left == 0) return done;
  auto mesh = to_half_edges(surface);
  mesh.request_vertex_status();
  mesh.request_edge_status();
  mesh.request_face_status();
  for (int round = 0; round < max_rounds; ++round) {
    bool has_changed = false;
    for (unsigned i = 0; i < mesh.n_faces(); ++i) {
      const auto f = mesh.face_handle(i);
      if (mesh.status(f).deleted()) continue;
      std::array<Vec3, 3> p;
      auto v = mesh.cfv_iter(f);
      for (Vec3& x : p) {
        const auto& point = mesh.point(*v++);
        x = {point[0], point[1], point[2]};
      }
      if (is_flat(p)) has_changed = mend_one(mesh, f, done) || has_changed;
    }
    if (!has_changed) break;
  }
  mesh.garbage_collection();
  surface = to_triangulation(mesh);
  geometry::drop_unused_points(surface);
  done.n_left = count();
  return done;
}

}  // namespace pamr::surface_mesh
