// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include "pamr/geometry/box.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::mesh {

/// The box around the boxes of all ranks. Collective: one reduction.
geometry::Box box_over_ranks(const par::Comm& comm, const geometry::Box& here);

/// The box around the nodes of a mesh; empty if it has none. Collective: one reduction.
geometry::Box box_of_nodes(const par::Comm& comm, const DistMesh& mesh);

}  // namespace pamr::mesh
