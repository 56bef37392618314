// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/geometry/fit_shape.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::meshing {

/// Angle by which the shape may turn along an edge of the mesh, degrees, for a patch to be said to fit it: from here on
/// faces meet in sharp edges.
inline constexpr double suggested_turn = 40;
/// The same for it to count as certain: prisms and pyramids of 12 sides and fewer are no cylinders and cones, and
/// geodesic polyhedra of 42 nodes and fewer no spheres.
constexpr double certain_turn(geometry::ShapeKind kind) {
  return kind == geometry::ShapeKind::cylinder || kind == geometry::ShapeKind::cone ? 29 : 35;
}
/// Largest distance of a node from a shape that its patch fits, and of three quarters of them where it is certain;
/// parts of the diagonal of the patch's box.
inline constexpr double suggested_distance = 1e-6, certain_distance = 1e-10;

/// A curved shape that a patch fits.
struct RecognizedShape {
  int patch = 0;
  geometry::FittedShape shape;
  geometry::DescribedSurface surface;  ///< of the patch's name
  std::int64_t n_faces = 0;            ///< of the patch
  double worst_distance = 0;           ///< of a node from the shape, length unit
  double worst_turn = 0;    ///< angle between the shape's normals at the ends of an edge, or around a cone, degrees
  bool is_certain = false;  ///< enough to bind the patch to it where that is asked for
};

/// Finds the patches with `is_wanted` that lie on a sphere, cylinder, cone or torus. Such a patch
/// - has at least three times as many nodes as the shape has unknowns, all within `suggested_distance` of it;
/// - is curved, and fits one kind of shape alone: nodes on two circles fit several;
/// - has faces whose normals deviate from the shape's no more than their edges and the shape's curvature explain, all
///   to the same side, along no edge of which the shape turns by more than `suggested_turn`.
///
/// Distances are those from `surface`, at all nodes and faces. Ascending by patch. The same on every
/// rank and for any number of ranks, partition and numbering. Collective: one sparse exchange of some hundred nodes of
/// each patch with their faces, and six reductions; none if no patch is wanted. Cost: O(cells) and about 10 ms for each
/// patch, patches shared out to the ranks.
std::vector<RecognizedShape> recognize_shapes(const par::Comm& comm, const mesh::DistMesh& mesh,
                                              const std::vector<bool>& is_wanted);

}  // namespace pamr::meshing
