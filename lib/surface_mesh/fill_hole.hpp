// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/version.h>

#include <iterator>
#include <vector>

namespace pamr::surface_mesh {

/// CGAL's filling of the hole at this halfedge of the border, smooth with the faces around; its faces and points are
/// appended, none if CGAL could not. Versions from 5.6 on take where they go as named parameters. `Mesh`: CGAL's
/// Surface_mesh; the caller is compiled with CGAL_EIGEN3_ENABLED. Local.
template <class Mesh>
void fill_hole(Mesh& mesh, typename Mesh::Halfedge_index border, std::vector<typename Mesh::Face_index>& faces,
               std::vector<typename Mesh::Vertex_index>& points) {
  namespace PMP = CGAL::Polygon_mesh_processing;
#if CGAL_VERSION_NR >= 1050600000
  PMP::triangulate_refine_and_fair_hole(mesh, border,
                                        CGAL::parameters::face_output_iterator(std::back_inserter(faces))
                                            .vertex_output_iterator(std::back_inserter(points)));
#else
  PMP::triangulate_refine_and_fair_hole(mesh, border, std::back_inserter(faces), std::back_inserter(points));
#endif
}

}  // namespace pamr::surface_mesh
