// SPDX-License-Identifier: GPL-3.0-or-later
#include "pamr/geometry/triangulated/self_intersection.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <fmt/format.h>

#include <algorithm>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "pamr/geometry/parameters.hpp"

namespace pamr::geometry {

SelfIntersections find_self_intersections(const Triangulation& surface, Exact<std::int64_t> most) {
  using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
  using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;
  Mesh mesh;
  for (const Vec3 p : surface.points) mesh.add_vertex({p.x, p.y, p.z});
  using Vertex = Mesh::Vertex_index;
  for (const auto& [a, b, c] : surface.triangles)
    mesh.add_face(Vertex(static_cast<Mesh::size_type>(a)), Vertex(static_cast<Mesh::size_type>(b)),
                  Vertex(static_cast<Mesh::size_type>(c)));
  std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
  CGAL::Polygon_mesh_processing::self_intersections(mesh, std::back_inserter(pairs),
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

std::string self_intersection_warning(const Triangulation& surface) {
  const auto found = find_self_intersections(surface);
  if (found.n_pairs == 0) return {};
  return fmt::format("surface \"{}\" cuts through itself: {}{} {} of triangles, the first near {}", surface.name,
                     found.n_pairs, found.has_more ? " or more" : "", found.n_pairs == 1 ? "pair" : "pairs",
                     decimal(found.where));
}

}  // namespace pamr::geometry
