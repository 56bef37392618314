// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/subdivide_surface.hpp"

#include <OpenMesh/Tools/Subdivider/Uniform/LoopT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/ModifiedButterFlyT.hh>
#include <array>
#include <span>
#include <stdexcept>
#include <vector>

#include "pamr/base/index.hpp"
#include "pamr/geometry/triangulated/edge_table.hpp"
#include "surface_mesh/half_edges.hpp"

namespace pamr::surface_mesh {

namespace {

template <class Subdivider>
void run(HalfEdges& mesh, int n_steps) {
  Subdivider subdivider;
  if (!subdivider.attach(mesh) || !subdivider(static_cast<std::size_t>(n_steps)))
    throw std::logic_error("OpenMesh could not subdivide a valid surface");
  subdivider.detach();
}

/// Each triangle into four, in place. OpenMesh's scheme of that name drops the old points.
geometry::Triangulation split_at_midpoints(const geometry::Triangulation& surface) {
  geometry::Triangulation result{.name = surface.name, .points = surface.points, .triangles = {}};
  std::vector<std::array<int, 3>> middle(surface.triangles.size());  // of the side from corner k to the next
  geometry::EdgeTable(surface).for_each_edge([&](std::span<const geometry::Side> sides) {
    for (const auto& side : sides) middle[at(side.triangle)][at(side.edge)] = static_cast<int>(result.points.size());
    result.points.push_back(midpoint(surface.points[at(sides[0].low)], surface.points[at(sides[0].high)]));
  });
  for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
    const auto [a, b, c] = surface.triangles[t];
    const auto [ab, bc, ca] = middle[t];
    for (const auto& child :
         {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c}, std::array{ab, bc, ca}})
      result.triangles.push_back(child);
  }
  return result;
}

}  // namespace

geometry::Triangulation subdivide(const geometry::Triangulation& surface, SubdivisionScheme scheme, int n_steps) {
  namespace Uniform = OpenMesh::Subdivider::Uniform;
  if (scheme == SubdivisionScheme::midpoint) {
    auto result = surface;
    for (int i = 0; i < n_steps; ++i) result = split_at_midpoints(result);
    return result;
  }
  auto mesh = to_half_edges(surface);
  if (scheme == SubdivisionScheme::loop)
    run<Uniform::LoopT<HalfEdges, double>>(mesh, n_steps);
  else
    run<Uniform::ModifiedButterflyT<HalfEdges, double>>(mesh, n_steps);
  return to_triangulation(mesh);
}

}  // namespace pamr::surface_mesh
