// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "pamr/geometry/cad/cad_model.hpp"
#include "pamr/geometry/cad/cad_source.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::meshing {

/// Where a patch lies on a CAD shape.
struct CadPatch {
  std::string patch;
  std::vector<int> faces;     ///< numbers from 1 on, ascending
  std::int64_t n_on = 0;      ///< boundary faces of the mesh on them
  std::int64_t n_off = 0;     ///< boundary faces on no face of the shape
  double worst_distance = 0;  ///< of a corner of the latter from the shape
  bool is_tied() const { return n_on > 0 && n_off == 0; }
};

/// How to look for the faces of a shape.
struct CadSearch {
  std::string unit;  ///< that the mesh is in
  /// How far corners of faces may be off, length units; negative: 1e-6 of the mesh's size, or the largest tolerance of
  /// the shape's edges if that is more.
  double tolerance = -1;
  std::vector<std::string> named;  ///< patches that are left alone
};

/// Finds by geometry on which face of a shape each boundary face of the mesh lies: one from which none of its corners
/// is farther than the tolerance, and of several the one that is nearest to its middle. The patches of the mesh without
/// those that are left alone. The patch of faces without a tag is split into one for each face of the shape, named as
/// the face, or face_N. Collective. Throws `Error` if nothing of the mesh is on the shape. The same on any number of
/// ranks. Cost: some projections for each boundary node and face.
std::vector<CadPatch> find_cad_faces(const par::Comm& comm, mesh::DistMesh& mesh, const geometry::CadModel& model,
                                     const geometry::CadSource& source, const CadSearch& search);

}  // namespace pamr::meshing
