// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"

namespace pamr::mesh {

/// Kind of the patches that the file of a mesh links as periodic. The links themselves are not kept.
inline constexpr const char* periodic_kind = "periodic";

/// What is to be said of periodic patches when a mesh is read or refined; empty: there are none. Local.
std::string warning_of_periodic(const std::vector<Patch>& patches);

}  // namespace pamr::mesh
