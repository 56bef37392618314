// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/self_intersection.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <boost/iterator/function_output_iterator.hpp>
#include <string>
#include <utility>

#include "pamr/base/index.hpp"
#include "pamr/geometry/box.hpp"
#include "pamr/geometry/parameters.hpp"

namespace pamr::geometry {

namespace {

using CutKernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using CutMesh = CGAL::Surface_mesh<CutKernel::Point_3>;
using FacePair = std::pair<CutMesh::Face_index, CutMesh::Face_index>;

CutMesh cgal_mesh_of(const Triangulation& surface) {
  CutMesh mesh;
  for (const Vec3 p : surface.points) mesh.add_vertex({p.x, p.y, p.z});
  using Vertex = CutMesh::Vertex_index;
  for (const auto& [a, b, c] : surface.triangles)
    mesh.add_face(Vertex(static_cast<CutMesh::size_type>(a)), Vertex(static_cast<CutMesh::size_type>(b)),
                  Vertex(static_cast<CutMesh::size_type>(c)));
  return mesh;
}

}  // namespace

void SelfIntersections::add(const Cut& cut) {
  if (n_pairs++ == 0 || std::pair(cut.first, cut.second) < std::pair(first.first, first.second)) first = cut;
}

bool cuts_itself(const Triangulation& surface) {
  return CGAL::Polygon_mesh_processing::does_self_intersect(cgal_mesh_of(surface));
}

void for_each_cut(const Triangulation& surface, const std::function<void(const Cut&)>& use) {
  const auto box = [&](int t) {
    Box result;
    for (const int p : surface.triangles[at(t)]) result.extend(surface.points[at(p)]);
    return result;
  };
  const auto tell = [&](const FacePair& pair) {
    const auto [first, second] = std::minmax({static_cast<int>(pair.first.idx()), static_cast<int>(pair.second.idx())});
    const Box a = box(first), b = box(second);
    const Vec3 low{std::max(a.low.x, b.low.x), std::max(a.low.y, b.low.y), std::max(a.low.z, b.low.z)};
    const Vec3 high{std::min(a.high.x, b.high.x), std::min(a.high.y, b.high.y), std::min(a.high.z, b.high.z)};
    use({first, second, midpoint(low, high)});
  };
  CGAL::Polygon_mesh_processing::self_intersections(cgal_mesh_of(surface), boost::make_function_output_iterator(tell));
}

SelfIntersections find_self_intersections(const Triangulation& surface) {
  SelfIntersections found;
  for_each_cut(surface, [&](const Cut& cut) { found.add(cut); });
  return found;
}

std::string self_intersection_warning(const Triangulation& surface, const SelfIntersections& found) {
  if (found.n_pairs == 0) return {};
  return fmt::format("surface \"{}\" cuts through itself: {} {} of triangles, the first near {}", surface.name,
                     found.n_pairs, found.n_pairs == 1 ? "pair" : "pairs", decimal(found.first.where));
}

}  // namespace pamr::geometry
