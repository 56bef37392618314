// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "report/camera.hpp"
#include "report/report_tables.hpp"

namespace pamr::report {

/// The view with which a page opens.
struct FirstView {
  std::string show;                 ///< "boundary", or the axis of a section through the middle: "y"
  std::string color;                ///< "level", or "patch" when all cells have the same level
  std::vector<std::string> hidden;  ///< names of the patches that are not drawn: the outer box
  Direction direction;              ///< one in which the bodies cover much of the picture
};

/// The bodies in a box without the box; a section of a mesh whose patches all lie on the sides of its box; else the
/// boundary. Of several meshes the last one decides. Local; one pass over the faces of the view.
FirstView first_view(const std::vector<ReportedMesh>& meshes);

/// Places of the meshes that are shown side by side at first: the only one, or the first and the last.
std::vector<std::size_t> first_meshes(const std::vector<ReportedMesh>& meshes);

/// Names of the patches of all meshes, each once, in the order in which they are met: their colors go by it.
std::vector<std::string> patch_names(const std::vector<ReportedMesh>& meshes);

/// Largest level of a cell of these meshes.
int deepest_level(const std::vector<ReportedMesh>& meshes);

}  // namespace pamr::report
