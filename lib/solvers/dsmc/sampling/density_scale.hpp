// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <span>
#include <vector>

#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::dsmc {

/// Length over which the density changes by itself, n / |grad n|, of each cell in the mesh's length unit; 1e30 where
/// there is no gas, and at most that.
///
/// The density at a node is that of all gas in the cells around it, the gradient that of the linear function through
/// the corners of a cell (`mark::nodal_means`, `mark::linear_gradient`): so the noise of one cell counts little, and
/// the result has the same bits on any number of ranks. `density`: 1/m3, one entry per own cell. Collective: finds the
/// shared nodes, two exchanges.
std::vector<double> density_scale(const par::Comm& comm, const mesh::DistMesh& mesh, std::span<const double> density);

}  // namespace pamr::dsmc
