// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>

namespace pamr::cli {

/// What --version prints for a tool of this name: a line with the version and the commit of the sources, and a line
/// with the versions of the libraries that decide about results and files. MPI and HDF5 are those that were loaded now,
/// CGAL and Scotch are part of the program. A third line names what was left out when PAMR was built, if anything was,
/// and the packages that it needs. Local.
std::string version_text(const std::string& tool);

/// The commit of the sources ("a1b2c3d", "a1b2c3d with changes"), or nothing where it is not known. Local.
std::string commit_of_sources();

}  // namespace pamr::cli
