// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "solvers/poisson_boltzmann/problem/pb_case.hpp"

namespace pamr::poisson_boltzmann {

/// Throws `Error`, which begins with `where`, if a patch of a body holds neither potential nor charge, or if a body of
/// several patches has the name of one. What patterns stand for is left to `resolve_names`. Local.
void require_bodies(const Case& input, const std::string& where);

/// The case with the names of the mesh's patches in the place of groups and patterns. In the patches of a body these
/// stand for those of given potential or charge. One of [boundary] that stands for no patch stays, for `make_domain` to
/// refuse. Throws `Error` if two groups or two patterns of [boundary] stand for one patch, a pattern of a body for none, and as
/// `require_bodies`. Local.
Case resolve_names(Case input, const std::vector<mesh::Patch>& patches, const std::string& where);

}  // namespace pamr::poisson_boltzmann
