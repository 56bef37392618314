// SPDX-License-Identifier: GPL-3.0-or-later
#include "surface_mesh/subdivide_surface.hpp"

#include <OpenMesh/Tools/Subdivider/Uniform/LoopT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/MidpointT.hh>
#include <OpenMesh/Tools/Subdivider/Uniform/ModifiedButterFlyT.hh>
#include <stdexcept>

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

}  // namespace

geometry::Triangulation subdivide(const geometry::Triangulation& surface, SubdivisionScheme scheme, int n_steps) {
  namespace Uniform = OpenMesh::Subdivider::Uniform;
  auto mesh = to_half_edges(surface);
  switch (scheme) {
    case SubdivisionScheme::midpoint:
      run<Uniform::MidpointT<HalfEdges, double>>(mesh, n_steps);
      break;
    case SubdivisionScheme::loop:
      run<Uniform::LoopT<HalfEdges, double>>(mesh, n_steps);
      break;
    case SubdivisionScheme::butterfly:
      run<Uniform::ModifiedButterflyT<HalfEdges, double>>(mesh, n_steps);
      break;
  }
  return to_triangulation(mesh);
}

}  // namespace pamr::surface_mesh
