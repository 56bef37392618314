// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <OpenMesh/Core/Mesh/TriMesh_ArrayKernelT.hh>

#include "pamr/geometry/triangulated/triangulation.hpp"

namespace pamr::surface_mesh {

struct HalfEdgeTraits : OpenMesh::DefaultTraits {
  using Point = OpenMesh::Vec3d;
  using Normal = OpenMesh::Vec3d;
};

/// The half-edge mesh of OpenMesh on which surfaces are edited.
struct HalfEdges : OpenMesh::TriMesh_ArrayKernelT<HalfEdgeTraits> {
  /// Whether taking the start of `h` to its end leaves a manifold. Hides OpenMesh's function, which answers the same:
  /// distributions build that one with assertions, where it takes almost half the time of a decimation.
  bool is_collapse_ok(HalfedgeHandle h) const;
};

/// Points and triangles keep their numbers. Pre: the surface is valid (`require_valid`), closed or not. Throws
/// `std::logic_error` when OpenMesh does not take all of it. Local; O(n).
HalfEdges to_half_edges(const geometry::Triangulation& surface);

/// What is not deleted, in order. Garbage must have been collected. Local; O(n).
geometry::Triangulation to_triangulation(const HalfEdges& mesh);

/// Marks edges between two triangles that meet at more than `feature_angle` degrees as features, and their points. Face
/// normals must be there, edge and vertex status requested. Returns how many edges.
std::size_t mark_features(HalfEdges& mesh, double feature_angle);

}  // namespace pamr::surface_mesh
