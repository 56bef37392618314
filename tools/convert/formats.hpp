// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

/// Names of files that pamr-convert reads and writes.
namespace pamr::convert {

/// How a name ends where a format of that ending is known: ".hdf", ".vtkhdf", ".msh", ".vtu", ".mesh", ".meshb",
/// ".su2",
/// ".ugrid" (after .lb8 or .b8) and, for outputs, ".cgns" and those of surfaces. Throws `Error` that lists them.
std::string ending_of_input(const std::string& file);
std::string ending_of_output(const std::string& file);

bool is_native_file(const std::string& file);
bool is_medit_file(const std::string& file);
/// Whether its elements are read one by one (`io::mesh_of_elements`): a mesh of another program, of level 0.
bool is_file_of_elements(const std::string& file);

}  // namespace pamr::convert
