// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "meshing/mesh_case.hpp"
#include "pamr/geometry/cad/cad_model.hpp"

namespace pamr::meshing {

/// The parts of a CAD file that are wanted.
struct CadRequest {
  std::string unit;                 ///< of the mesh
  double far = 0;                   ///< largest wanted edge length; 0: a fifteenth of the size of the shape
  std::vector<std::string> solids;  ///< names of those to take (`geometry::assemble_cad`); empty: all
};

/// The case to mesh the inside of a CAD shape. Faces of one name become a patch of that name; faces without name but of
/// one color a patch color_RRGGBB; any other face a patch of its own, face_N. Each of several solids is a region, and
/// the faces between two are one patch, A_B after their names. Throws `Error` for a file that cannot be read, solids
/// that overlap, and faces beside several solids.
MeshCase case_of_cad(const std::filesystem::path& file, const CadRequest& request);

/// True where every surface is on a CAD shape.
bool is_all_cad(const geometry::SurfaceSet& surfaces);
/// Makes a box around the shapes the bounds of a combination of CAD surfaces.
void bound_by_shapes(Combination& combination);

}  // namespace pamr::meshing
