// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::meshing {

/// The mesh with boundary nodes that lie in one place made one (`check::nodes_by_place`): the one of smallest number
/// keeps its coordinates and values. Faces that lie on each other become inner ones. Cells keep their order and values,
/// nodes the order of those that are left.
/// Pre: all cells are of level 0. Collective. Throws `Error` on every rank where cells cannot be joined so: a cell with
/// two nodes in one place, three faces in one.
mesh::DistMesh weld(const par::Comm& comm, mesh::DistMesh mesh);

}  // namespace pamr::meshing
