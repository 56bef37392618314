// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::mesh {

/// Indices of the patches that a name given by a user stands for: of the patch of that name and those in a group of that
/// name, or else of all for which, or for a group of which, it stands as a pattern (base/name_pattern.hpp). Empty if
/// there is none. Local.
std::vector<int> find_patches(const std::vector<Patch>& patches, const std::string& name);

/// The same; throws `Error`, which begins with `where` and lists the mesh's patches, if there is none. Local.
std::vector<int> require_patches(const std::vector<Patch>& patches, const std::string& name, const std::string& where);

/// Names of the groups that the faces of a patch are in, where these are several.
std::vector<std::string> group_names(const Patch& patch);

/// The patches' names for a message: "inlet, wall"; "none" without patches.
std::string list_patches(const std::vector<Patch>& patches);

}  // namespace pamr::mesh
