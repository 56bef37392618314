// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/self_intersection.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <boost/iterator/function_output_iterator.hpp>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

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

SelfIntersections find_self_intersections(const Triangulation& surface, Exact<std::int64_t> most) {
  std::vector<FacePair> pairs;
  CGAL::Polygon_mesh_processing::self_intersections(cgal_mesh_of(surface), std::back_inserter(pairs),
                                                    CGAL::parameters::maximum_number(static_cast<unsigned int>(most)));
  SelfIntersections result;
  result.n_pairs = static_cast<std::int64_t>(pairs.size());
  result.has_more = result.n_pairs >= most;
  if (pairs.empty()) return result;
  const auto first = std::min_element(pairs.begin(), pairs.end())->first;
  const auto corner = surface.triangles[static_cast<std::size_t>(first.idx())][0];
  result.where = surface.points[static_cast<std::size_t>(corner)];
  return result;
}

void for_each_cut(const Triangulation& surface, const std::function<void(const Cut&)>& use) {
  const auto box = [&](int t) {
    Box result;
    for (const int p : surface.triangles[at(t)]) result.extend(surface.points[at(p)]);
    return result;
  };
  const auto tell = [&](const FacePair& pair) {
    const int first = static_cast<int>(pair.first.idx()), second = static_cast<int>(pair.second.idx());
    const Box a = box(first), b = box(second);
    const Vec3 low{std::max(a.low.x, b.low.x), std::max(a.low.y, b.low.y), std::max(a.low.z, b.low.z)};
    const Vec3 high{std::min(a.high.x, b.high.x), std::min(a.high.y, b.high.y), std::min(a.high.z, b.high.z)};
    use({first, second, midpoint(low, high)});
  };
  CGAL::Polygon_mesh_processing::self_intersections(cgal_mesh_of(surface), boost::make_function_output_iterator(tell));
}

std::string self_intersection_warning(const Triangulation& surface) {
  const auto found = find_self_intersections(surface);
  if (found.n_pairs == 0) return {};
  return fmt::format("surface \"{}\" cuts through itself: {}{} {} of triangles, the first near {}", surface.name,
                     found.n_pairs, found.has_more ? " or more" : "", found.n_pairs == 1 ? "pair" : "pairs",
                     decimal(found.where));
}

}  // namespace pamr::geometry
