// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <CGAL/version.h>

#include <iterator>
#include <vector>

#include "surface_mesh/cgal_mesh.hpp"

namespace pamr::surface_mesh {

/// CGAL's filling of the hole at this halfedge of the border, smooth with the faces around; its faces and points are
/// appended, none if CGAL could not. Versions from 5.6 on take where they go as named parameters. Local.
inline void fill_hole(CgalMesh& mesh, CgalMesh::Halfedge_index border, std::vector<CgalMesh::Face_index>& faces,
                      std::vector<CgalMesh::Vertex_index>& points) {
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
