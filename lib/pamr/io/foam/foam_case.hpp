// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <filesystem>
#include <string>
#include <vector>

#include "pamr/io/elements/whole_mesh.hpp"

/// Other data in the folder of a case: times, regions, sets. Local. Source: OpenFOAM user guide, "File structure of OpenFOAM cases".
namespace pamr::io::foam {

/// Names of the regions of a case that have a mesh of their own (`constant/NAME/polyMesh`), ascending.
std::vector<std::string> regions_of_case(const std::filesystem::path& case_folder);

/// Says what `read_foam` leaves out: other files of `polyMesh` and meshes of later times as remarks, fields of times and
/// further regions as notes.
void tell_of_other_data(const std::filesystem::path& case_folder, const std::filesystem::path& mesh_folder,
                        WholeMesh& mesh);

}  // namespace pamr::io::foam
