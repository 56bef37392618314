// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/mend.hpp"

#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Polygon_mesh_processing/stitch_borders.h>
#include <CGAL/boost/graph/Euler_operations.h>
#include <CGAL/boost/graph/selection.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <set>
#include <utility>
#include <vector>

#include "pamr/geometry/triangulated/edge_table.hpp"
#include "pamr/geometry/triangulated/groups.hpp"
#include "surface_mesh/cgal_mesh.hpp"
#include "surface_mesh/fill_hole.hpp"

namespace pamr::surface_mesh {

namespace {

namespace PMP = CGAL::Polygon_mesh_processing;
using geometry::Triangulation;
using geometry::Vec3;
using Face = CgalMesh::Face_index;
using Halfedge = CgalMesh::Halfedge_index;
using Vertex = CgalMesh::Vertex_index;

/// Hears from CGAL what it changes.
struct Listener : PMP::Default_orientation_visitor {
  Oriented* done = nullptr;
  std::vector<char>* is_turned = nullptr;
  std::set<std::pair<std::size_t, std::size_t>>* cut_edges = nullptr;

  /// Called for each triangle there.
  void non_manifold_edge(std::size_t a, std::size_t b, std::size_t) { cut_edges->insert(std::minmax(a, b)); }
  void duplicated_vertex(std::size_t, std::size_t) { ++done->n_new_points; }
  void polygon_orientation_reversed(std::size_t t) { (*is_turned)[t] ^= 1; }
};

/// Turns pieces back of which the larger area was turned over.
void keep_larger_part(Triangulation& surface, std::vector<char>& is_turned) {
  geometry::Groups pieces(surface.triangles.size());
  geometry::EdgeTable(surface).for_each_edge([&](std::span<const geometry::Side> sides) {
    if (sides.size() == 2) pieces.join(sides[0].triangle, sides[1].triangle);
  });
  std::vector<double> balance(surface.triangles.size(), 0);  // area that was turned less area that was not
  for (int t = 0; t < std::ssize(surface.triangles); ++t) {
    const auto& [a, b, c] = surface.triangles[at(t)];
    const Vec3 p = surface.points[at(a)];
    const double area = norm(cross(surface.points[at(b)] - p, surface.points[at(c)] - p));
    balance[at(pieces.of(t))] += is_turned[at(t)] != 0 ? area : -area;
  }
  for (int t = 0; t < std::ssize(surface.triangles); ++t) {
    if (!(balance[at(pieces.of(t))] > 0)) continue;
    std::swap(surface.triangles[at(t)][1], surface.triangles[at(t)][2]);
    is_turned[at(t)] ^= 1;
  }
}

struct Hole {
  std::size_t n_edges = 0;
  double size = 0;  // diagonal of its box
};

Hole measure(const CgalMesh& mesh, Halfedge start) {
  Hole hole;
  CGAL::Bbox_3 box;
  for (const auto h : CGAL::halfedges_around_face(start, mesh)) {
    ++hole.n_edges;
    box += mesh.point(mesh.target(h)).bbox();
  }
  hole.size = std::hypot(box.xmax() - box.xmin(), box.ymax() - box.ymin(), box.zmax() - box.zmin());
  return hole;
}

/// Keeps CGAL from printing what it throws.
void silence(const char*, const char*, const char*, int, const char*) {}

/// Fills one hole; false if CGAL could not, then nothing is changed.
bool fill(CgalMesh& mesh, Halfedge hole, std::vector<Face>& faces, std::vector<Vertex>& points) {
  const auto n_faces = faces.size();
  fill_hole(mesh, hole, faces, points);
  return faces.size() > n_faces;
}

using Pairs = std::vector<std::pair<Face, Face>>;

Pairs cutting_pairs(const CgalMesh& mesh) {
  Pairs pairs;
  PMP::self_intersections(mesh, std::back_inserter(pairs));
  return pairs;
}

struct Replaced {
  bool all_filled = true;
  std::int64_t n_removed = 0, n_added = 0;
};

/// Takes the triangles of the pairs out, with `n_rings` rings around, and fills the holes that this makes.
Replaced replace(CgalMesh& mesh, const Pairs& pairs, unsigned n_rings) {
  std::set<Halfedge> old_ends;
  for (const auto h : mesh.halfedges())
    if (mesh.is_border(h)) old_ends.insert(h);
  auto is_chosen = mesh.add_property_map<Face, bool>("f:is_chosen", false).first;
  std::vector<Face> chosen;
  for (const auto& [a, b] : pairs)
    for (const auto f : {a, b})
      if (!is_chosen[f]) {
        is_chosen[f] = true;
        chosen.push_back(f);
      }
  const auto first = chosen;
  CGAL::expand_face_selection(first, mesh, n_rings, is_chosen, std::back_inserter(chosen));
  CGAL::expand_face_selection_for_removal(chosen, mesh, is_chosen);
  chosen.clear();
  for (const auto f : mesh.faces())
    if (is_chosen[f]) chosen.push_back(f);
  for (const auto f : chosen) CGAL::Euler::remove_face(mesh.halfedge(f), mesh);
  mesh.remove_property_map(is_chosen);
  std::vector<Halfedge> holes;
  PMP::extract_boundary_cycles(mesh, std::back_inserter(holes));
  Replaced done{.n_removed = std::ssize(chosen)};
  std::vector<Face> faces;
  std::vector<Vertex> points;
  for (const auto hole : holes) {
    const auto around = CGAL::halfedges_around_face(hole, mesh);
    if (std::any_of(around.begin(), around.end(), [&](Halfedge h) { return old_ends.count(h) > 0; })) continue;
    done.all_filled = fill(mesh, hole, faces, points) && done.all_filled;
  }
  done.n_added = std::ssize(faces);
  return done;
}

std::size_t n_concerned(const Pairs& pairs) {
  std::set<Face> faces;
  for (const auto& [a, b] : pairs) faces.insert({a, b});
  return faces.size();
}

}  // namespace

Oriented orient_and_part(Triangulation& surface) {
  Oriented done;
  std::vector<char> is_turned(surface.triangles.size(), 0);
  Listener listener;
  listener.done = &done;
  listener.is_turned = &is_turned;
  std::set<std::pair<std::size_t, std::size_t>> cut_edges;
  listener.cut_edges = &cut_edges;
  PMP::orient_polygon_soup(surface.points, surface.triangles, CGAL::parameters::visitor(listener));
  keep_larger_part(surface, is_turned);
  done.n_cut_edges = std::ssize(cut_edges);
  done.n_turned = std::count(is_turned.begin(), is_turned.end(), char{1});
  return done;
}

std::int64_t stitch(Triangulation& surface) {
  auto mesh = to_cgal(surface);
  const auto n = PMP::stitch_borders(mesh);
  if (n > 0) surface = from_cgal(mesh);
  return static_cast<std::int64_t>(n);
}

ClosedHoles close_holes(Triangulation& surface, double max_size) {
  constexpr std::size_t max_edges = 500;  // time grows with the cube
  CGAL::set_error_handler(silence);
  std::set<std::size_t> without;  // holes at which CGAL gave up half-way
  for (;;) {
    ClosedHoles done;
    auto mesh = to_cgal(surface);
    std::vector<Halfedge> holes;
    PMP::extract_boundary_cycles(mesh, std::back_inserter(holes));
    std::vector<Face> faces;
    std::vector<Vertex> points;
    std::size_t i = 0;
    try {
      for (; i < holes.size(); ++i) {
        const auto [n_edges, size] = measure(mesh, holes[i]);
        if (!(size <= max_size) || n_edges > max_edges)
          ++done.n_large;
        else
          ++(without.count(i) == 0 && fill(mesh, holes[i], faces, points) ? done.n_holes : done.n_failed);
      }
    } catch (const CGAL::Failure_exception&) {
      without.insert(i);
      continue;
    }
    done.n_triangles = std::ssize(faces);
    done.n_points = std::ssize(points);
    if (done.n_holes > 0) surface = from_cgal(mesh);
    return done;
  }
}

std::vector<int> cutting_triangles(const Triangulation& surface) {
  std::set<int> triangles;
  for (const auto& [a, b] : cutting_pairs(to_cgal(surface)))
    for (const auto f : {a, b}) triangles.insert(static_cast<int>(f.idx()));
  return {triangles.begin(), triangles.end()};
}

Resolved resolve_intersections(Triangulation& surface) {
  constexpr std::size_t max_share = 10;
  constexpr unsigned max_rings = 6;
  CGAL::set_error_handler(silence);
  Resolved done;
  auto best = to_cgal(surface);
  auto pairs = cutting_pairs(best);
  done.n_pairs = done.n_pairs_left = std::ssize(pairs);
  if (n_concerned(pairs) * max_share > surface.triangles.size()) return done;
  for (unsigned n_rings = 1; n_rings <= max_rings && !pairs.empty(); ++n_rings) {
    try {
      auto mesh = best;
      const auto replaced = replace(mesh, pairs, n_rings);
      if (!replaced.all_filled) continue;
      auto left = cutting_pairs(mesh);
      if (left.size() >= pairs.size()) continue;
      best = std::move(mesh);
      pairs = std::move(left);
      done.n_removed += replaced.n_removed;
      done.n_added += replaced.n_added;
      n_rings = 0;  // other places may need no more than a few neighbors
    } catch (const CGAL::Failure_exception&) {
      continue;  // `best` is as it was
    }
  }
  if (done.n_removed == 0) return done;
  done.n_pairs_left = std::ssize(pairs);
  surface = from_cgal(best);
  return done;
}

}  // namespace pamr::surface_mesh
