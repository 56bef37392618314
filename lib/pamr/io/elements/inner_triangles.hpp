// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once

#include <cstdint>
#include <vector>

#include "pamr/mesh/block_mesh.hpp"
#include "pamr/mesh/dist_mesh.hpp"
#include "pamr/par/comm.hpp"

namespace pamr::io {

/// Takes the triangles out of `boundary` that lie on a face between cells of two regions: the regions say where it is.
/// Returns for each of `n_groups` (the values of `boundary.patch`) how many these were. Collective.
std::vector<std::int64_t> take_out_inner_triangles(const par::Comm& comm, const mesh::DistMesh& mesh,
                                                   mesh::BoundaryTriangles& boundary, std::size_t n_groups);

}  // namespace pamr::io
