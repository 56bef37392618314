// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <string>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"
#include "solvers/poisson_boltzmann/problem/pb_case.hpp"

/// Sheets: patches whose faces lie inside the liquid (`mesh::InnerPatches`) and have a given potential, or a charge
/// that both sides hold together. Everything counts both sides of a face, each on the rank of its cell: the potential
/// holds for both, and of a charge each takes half. So the load of a face is that of its integral once, on any number
/// of ranks, and the charge of a given potential is the jump of the flux.
namespace pamr::poisson_boltzmann {

/// The case with what it says of patches inside: `Boundary::is_inside` is set for those that lie inside alone and are
/// named by their own name or that of a group; others of them lose what a pattern says, and are listed with
/// `Case::open_inside`, as are patches with faces on the boundary and inside of which the latter hold nothing.
/// Collective: two reductions. Throws `Error` where a patch inside has a condition that is neither a potential nor a
/// charge, is the plate of a profile or the mid-plane, where a pattern stands for such patches alone, and where a patch
/// that lies inside in part has a charge. Pre: `input` comes from `resolve_names`.
Case with_sheets(const par::Comm& comm, Case input, const mesh::DistMesh& mesh, const std::string& where);

/// Of each patch whether its faces inside hold a potential or a charge. Local.
std::vector<bool> sheets_of(const Case& input, const std::vector<mesh::Patch>& patches);

}  // namespace pamr::poisson_boltzmann
